# SPDX-License-Identifier: MIT
# Completion for bash: verbs and flags, as the program itself names them; files everywhere else.
_seqloop() {
  local word=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]} words
  COMPREPLY=()
  if [ "$COMP_CWORD" = 1 ]; then
    words="--help --help-all --version $("$program" --help 2>/dev/null | sed '1,/^Subcommands:/d' | awk '{print $1}')"
  elif [[ $word == -* ]]; then
    words=$("$program" "${COMP_WORDS[1]}" --help-all 2>/dev/null | grep -oE '^ +(-h,)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
  else
    # A flag that is either on or off says so in its help.
    local flag=${COMP_WORDS[COMP_CWORD - 1]}
    "$program" "${COMP_WORDS[1]}" --help-all 2>/dev/null | grep -qE -- "^ +$flag on\|off" && words="on off"
  fi
  # shellcheck disable=SC2207 # none of them holds a space
  [ -z "${words:-}" ] || COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _seqloop seqloop
