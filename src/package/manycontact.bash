# Completion of manycontact for bash: what each command's --help says.
_manycontact() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} program=${COMP_WORDS[0]} help
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    help=$("$program" --help 2>/dev/null | sed -n 's/^usage: manycontact \([a-z]*\) .*/\1/p')
    mapfile -t COMPREPLY < <(compgen -W "$help --help --version" -- "$word")
    return
  fi
  help=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null)
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(sed -n 's/^  \(--[a-z-]*\).*/\1/p' <<<"$help") --help" -- "$word")
  elif [[ $before == --* ]] && help=$(sed -n "s/^  $before .*\(one of\|: \)\(.*, .*\)/\2/p" <<<"$help") && [[ $help ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${help//,/ }" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames
  fi
}
complete -F _manycontact manycontact
