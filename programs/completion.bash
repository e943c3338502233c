# Completion of the programs' command lines, and of ./run and tetsuame: `source programs/completion.bash` in ~/.bashrc; in
# ~/.zshrc after `autoload -U +X bashcompinit && bashcompinit`. Keys of --set come from the program's own --describe.

_tetsuame_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$2"); }
_tetsuame_files() { mapfile -t COMPREPLY < <(compgen -f -X '!*.nml' -- "$1"; compgen -d -S / -- "$1"); }

# group.key= of all keys that this program, with this input, has.
_tetsuame_keys() {
  "$1" "${@:2}" --describe 2>/dev/null |
    awk '/^&/ { group = substr($1, 2) } /^ *[a-z_0-9]+ =/ { print group "." $1 "=" }'
}

_tetsuame_program() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} input=() other
  for other in "${COMP_WORDS[@]:1}"; do [[ $other != *.nml ]] || input=("$other"); done
  case $before in
    --set) compopt -o nospace; _tetsuame_words "$(_tetsuame_keys "${COMP_WORDS[0]}" "${input[@]}")" "$word" ;;
    --output) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    --restart) _tetsuame_words "latest" "$word" ;;
    *)
      case $word in
        -*) _tetsuame_words "$("${COMP_WORDS[0]}" --help | grep -oE '^ +(-h,)?--[a-z-]+' | grep -oE -- '--[a-z-]+')" "$word" ;;
        *) _tetsuame_files "$word" ;;
      esac
      ;;
  esac
}

_tetsuame_run() {
  local word=${COMP_WORDS[COMP_CWORD]}
  if ((COMP_CWORD == 1)); then
    _tetsuame_words "build test compare plot movie view paraview sweep bench balance plan submit package check help" "$word"
  elif [[ $word == -* ]]; then
    _tetsuame_words "--help --output --set" "$word"
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}

complete -F _tetsuame_program -o filenames disph_{a,b,c,d,e,f,y,n} ssph rti drop conduction convection shock balance
complete -F _tetsuame_run -o filenames run ./run tetsuame
