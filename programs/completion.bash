# Completion of the programs' command lines, and of ./run and tetsuame: `source programs/completion.bash` in ~/.bashrc; in
# ~/.zshrc after `autoload -U +X bashcompinit && bashcompinit`. Keys of --set come from the program's own --describe.

# No mapfile: zsh has none.
_tetsuame_words() {
  local IFS=$' \n'
  COMPREPLY=($(compgen -W "$1" -- "$2"))
}
# _tetsuame_paths WORD [OPTIONS of compgen, those of files by default]
_tetsuame_paths() {
  local IFS=$'\n' word=$1
  shift
  COMPREPLY=($(compgen "${@:--f}" -- "$word"))
}
_tetsuame_files() {
  local folders
  _tetsuame_paths "$1" -d -S /
  folders=("${COMPREPLY[@]}")
  _tetsuame_paths "$1" -f -X '!*.nml'
  COMPREPLY+=("${folders[@]}")
}

# group.key= of all keys that this program, with this input, has.
_tetsuame_keys() {
  "$1" "${@:2}" --describe 2>/dev/null |
    awk '/^&/ { group = substr($1, 2) } /^ *[a-z_0-9]+ =/ { print group "." $1 "=" }'
}

_tetsuame_program() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} input=() other
  for other in "${COMP_WORDS[@]:1}"; do [[ $other != *.nml ]] || input=("$other"); done
  case $before in
    --set) compopt -o nospace 2>/dev/null; _tetsuame_words "$(_tetsuame_keys "${COMP_WORDS[0]}" "${input[@]}")" "$word" ;;
    --output) _tetsuame_paths "$word" -d ;;
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
    _tetsuame_words "build test compare plot movie view paraview sweep building bench balance plan submit package check help" "$word"
  elif [[ $word == -* ]]; then
    _tetsuame_words "--help --output --set" "$word"
  else
    _tetsuame_paths "$word"
  fi
}

complete -F _tetsuame_program -o filenames disph_{a,b,c,d,e,f,f2,y,n} ssph rti drop conduction convection shock planet granular flow balance
complete -F _tetsuame_run -o filenames run ./run tetsuame
