# stickslip: completion for bash. Type: source <(stickslip completion bash)
_stickslip() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} words
    case ${{COMP_WORDS[1]}} in
{cases}
        *) words="{commands}" ;;
    esac
    (( COMP_CWORD == 1 )) && words="{commands}"
    COMPREPLY=($(compgen -W "$words" -- "$word"))
    (( ${{#COMPREPLY[@]}} )) || COMPREPLY=($(compgen -f -- "$word"))
    [[ ${{#COMPREPLY[@]}} -eq 1 && ${{COMPREPLY[0]}} == *= ]] && compopt -o nospace
}}
complete -F _stickslip stickslip
