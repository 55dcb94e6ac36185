# Completion for truebearing: commands and options as --help lists them, so that they need no list here; the studies and
# scenarios that come with the program by name; files for everything else.
_truebearing() {
  local current=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} folder="" words data
  if ((COMP_CWORD == 1)); then
    words=$("$program" --help 2>/dev/null | sed -n -e '/^Subcommands:/,$s/^  \([a-z]\{1,\}\) .*/\1/p' \
                                                   -e 's/^  .*\(--[a-z-]*\).*/\1/p')
  elif [[ $current == -* ]]; then
    words=$("$program" "$command" --help 2>/dev/null | sed -n 's/^  \(-[a-z],\)\{0,1\}\(--[a-z-]*\).*/\2/p')
  elif ((COMP_CWORD == 2)); then
    case $command in
      simulate) folder=scenarios ;;
      new) folder=templates ;;
      tune | train | learn | track | compare | check) folder=studies ;;
    esac
    if [[ $folder ]] && data=$("$program" --data-dir 2>/dev/null); then
      words=$(cd "$data/data/$folder" && printf '%s\n' *.toml)
      words=${words//.toml/}
    fi
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  if ((COMP_CWORD > 1)) && [[ $current != -* ]]; then
    mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -o filenames -F _truebearing truebearing
