#!/usr/bin/env bash
# ./run lint : what a reviewer should not have to say.
# Checks the layout (clang-format), the checks of .clang-tidy, that folders include only what lies
# below them, that every folder has its overview, and the shell scripts. Ends with 0 when all hold.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/common.sh
source scripts/common.sh

num_faults=0
fault() {
  printf '%s\n' "$*" >&2
  num_faults=$((num_faults + 1))
}

check_layout() {
  say "layout"
  local places  # FILE:LINE, each once
  places=$(sources | xargs clang-format-14 --dry-run 2>&1 | grep -oE '^\./[^: ]+:[0-9]+' |
    sort -t : -k 1,1 -k 2,2n -u || true)
  [[ -z $places ]] || fault "$places"$'\n'"way out: ./run format"
}

# layer FOLDER ALLOWED...: of the project's own folders, FOLDER includes only those named.
layer() {
  local folder=$1 own_folders='geometry|optimizer|methods|render|proto|lightfit|io|calls|server|cli|python|fuzz|bench|tests' hit hits
  shift
  [[ -d $folder ]] || return 0
  hits=$(grep -rnE --include='*.h' --include='*.cc' "^#include \"($own_folders)/" "$folder" |
    grep -vE "#include \"($(IFS='|' && echo "$*"))/" || true)
  while read -r hit; do
    [[ -z $hit ]] || fault "$hit: $folder/ may include only: $*"
  done <<<"$hits"
}

check_layers() {
  say "one-way dependencies"
  layer geometry geometry
  layer optimizer geometry optimizer
  layer methods geometry methods
  layer render geometry optimizer render
  layer proto proto lightfit
  layer io geometry optimizer proto lightfit io
  layer calls geometry optimizer proto lightfit io calls
  layer server io calls lightfit server
  layer cli geometry optimizer methods render proto lightfit io calls server cli
  layer python geometry optimizer lightfit io calls python
  layer examples geometry optimizer render lightfit
  layer fuzz geometry optimizer render lightfit io calls fuzz
  layer bench geometry optimizer methods render proto lightfit io calls server cli bench tests
  local hits
  hits=$(grep -rnE '^#include ["<](OpenImageIO|google/protobuf|CLI|grpc)' geometry optimizer || true)
  [[ -z $hits ]] || fault "$hits"$'\n'"geometry/ and optimizer/ know nothing of files and protobuf"
}

# The overview of a folder is its README.md, or the opening of its main file. Public headers open
# with their own path, so that excerpts tell where they live.
check_overviews() {
  say "overviews"
  local folder header
  for folder in geometry optimizer methods render proto io calls server cli python fuzz bench tests examples docs \
    scripts; do
    [[ -d $folder ]] || continue
    [[ -e $folder/README.md ]] ||
      grep -rlsE "^(//|#) $folder/ : |^// $folder/[a-z_]+\.h : " "$folder" >/dev/null ||
      fault "$folder/: no overview; write $folder/README.md, or open its main header with" \
        "\"// $folder/NAME.h : what it is\""
  done
  for header in {geometry,optimizer,methods,render,io,calls,server}/*.h; do
    [[ ! -e $header ]] || head -n 1 "$header" | grep -q "^// $header\b" ||
      fault "$header:1: want the first line to be \"// $header\""
  done
}

check_scripts() {
  say "shell scripts"
  shellcheck -x run .ci/run scripts/*.sh || fault "shellcheck is not content"
}

# inputs_of_sources: "SOURCE FILE" for each file of the project that the release build read for
# SOURCE, itself included. Ninja keeps these lists; the first of each is the source.
inputs_of_sources() {
  ninja -C build/release -t deps | awk -v root="$PWD/" '
    /^[^ ].*: #deps/ { source = ""; next }
    /^ / {
      file = $1
      if (index(file, root) == 1) file = substr(file, length(root) + 1)
      sub(/^\.\.\/\.\.\//, "", file)
      if (file ~ /^\// || file ~ /^build\//) next
      if (source == "") source = file
      if (source ~ /\.cc$/) print source, file
    }'
}

# A file that passed is not looked at again until it, a header of the project that it includes, or
# the settings change: build/lint/ keeps one empty file, named by their hash, for each pass.
check_tidy() {
  say "clang-tidy"
  mkdir -p build/lint
  local source key pending=()
  while read -r key source; do
    [[ -e build/lint/$key ]] || pending+=("$key" "$source")
  done < <(tidy_keys)
  echo "$((${#pending[@]} / 2)) files to look at" >&2
  ((${#pending[@]})) || return 0
  # shellcheck disable=SC2016  # $0 and $1 are the inner shell's
  printf '%s\n' "${pending[@]}" | xargs -P "$(num_jobs)" -n 2 nice bash -c '
    if report=$(clang-tidy-14 --quiet -p build/release "$1" 2>&1); then
      touch "build/lint/$0"
    else
      printf "%s\n" "$report" | grep -vE "^[0-9]+ warnings? (generated|treated)|^Suppressed|^Use -h"
      exit 1
    fi' || fault "clang-tidy is not content"
}

# tidy_keys: "HASH SOURCE" for each source of the release build.
tidy_keys() {
  local settings file_hashes
  settings=$({ cat .clang-tidy && clang-tidy-14 --version; } | sha256sum | cut -c 1-16)
  file_hashes=$(sources | xargs sha256sum)
  inputs_of_sources | sort -u | awk -v hashes="$file_hashes" -v settings="$settings" '
    BEGIN {
      count = split(hashes, lines, "\n")
      for (i = 1; i <= count; ++i) { split(lines[i], part); hash[substr(part[2], 3)] = part[1] }
    }
    { inputs[$1] = inputs[$1] " " $2 " " hash[$2] }
    END { for (source in inputs) print source, settings, inputs[source] }' |
    while read -r source inputs; do
      echo "$(sha256sum <<<"$inputs" | cut -c 1-32) $source"
    done | sort -k 2
}

need_packages packages.txt packages-lint.txt
build release >/dev/null  # clang-tidy reads its commands, and headers that it generates
check_layout
check_layers
check_overviews
check_scripts
check_tidy
((num_faults == 0)) || die "lint: $num_faults faults, see above"
say "lint: no faults, $SECONDS s"
