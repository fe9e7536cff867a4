#!/bin/sh
# Makes the man pages limber.1 and limber-COMMAND.1 of what --help says.
#   man_pages.sh LIMBER FOLDER
set -eu
limber=$1 folder=$2
date=$("$limber" --version | sed -n 's/.* of //p')
mkdir -p "$folder"

# Text as roff takes it: no line is an instruction, no backslash an escape.
plain() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }

page() {
  name=$1 help=$2
  first=$(printf '%s\n' "$help" | head -1)
  printf '.TH %s 1 "%s" "Limber %s" "Limber"\n' "$(printf '%s' "$name" | tr a-z A-Z)" "$date" "$version"
  printf '.SH NAME\n%s \\- %s\n' "$(printf '%s' "$name" | plain)" "$(printf '%s' "$first" | plain)"
  printf '.SH DESCRIPTION\n.nf\n'
  printf '%s\n' "$help" | tail -n +2 | plain
  printf '.fi\n.SH SEE ALSO\n.BR limber (1)\n'
}

version=$("$limber" --version | cut -d, -f1)
page limber "$("$limber" --help)" >"$folder/limber.1"
"$limber" --help | sed -n '/^Subcommands:/,$s/^  \([a-z][a-z-]*\) .*/\1/p' | while read -r command; do
  page "limber-$command" "$("$limber" "$command" --help)" >"$folder/limber-$command.1"
done
