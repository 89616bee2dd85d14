#!/bin/sh
# man.sh PROGRAM: its page for man(1), made of what it says of itself.
set -eu
lines() { sed 's/\\/\\\\/g; s/-/\\-/g; s/^\./\\\&./' ; }  # text as troff takes it
version=$("$1" --version)
echo ".TH MANYCONTACT 1 \"\" \"$version\""
echo ".SH NAME"
"$1" --help | head -n 1 | sed 's/: / \\- /'
echo ".SH SYNOPSIS"
echo ".nf"
"$1" --help | sed -n 's/^usage: //p' | lines
echo ".fi"
echo ".SH COMMANDS"
for command in $("$1" --help | sed -n 's/^usage: manycontact \([a-z]*\) .*/\1/p'); do
  echo ".SS $command"
  echo ".nf"
  "$1" "$command" --help | sed '1,2d' | lines
  echo ".fi"
done
echo ".SH FILES"
echo "/usr/share/manycontact/models: scenes and tasks to try; README.md there describes their files."
