#compdef stickslip
# stickslip: completion for zsh. Type: source <(stickslip completion zsh)
_stickslip() {{
    local -a names
    if (( CURRENT == 2 )); then
        names=({commands})
    else
        case $words[2] in
{cases}
        esac
    fi
    compadd -S '' -- ${{(M)names:#*=}}
    compadd -- ${{names:#*=}}
    _files
}}
compdef _stickslip stickslip
