# stickslip: completion for fish. Type: stickslip completion fish | source
complete -c stickslip -n __fish_use_subcommand -f
{commands}
{cases}
