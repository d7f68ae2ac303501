#!/usr/bin/env bash
# ./run lint [CHECK...] : what a reviewer should not have to say.
# Checks the layout (clang-format), that folders include only what lies below them and are not
# crowded, that every folder has its overview, that benchmarks are there by the names they are
# quoted by, the shell scripts, and the checks of .clang-tidy, or
# those named alone. Ends with 0 when all hold.
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

check_layers() {
  say "one-way dependencies"
  /usr/bin/python3 scripts/check_layers.py >&2 || fault "the layers are in scripts/check_layers.py"
  # Nobody finds their way in a folder of fifty files. Corpora are data.
  local crowded
  crowded=$(find . \( -path ./build -o -path ./out -o -path ./.git -o -path ./fuzz/corpus \
    -o -name node_modules -o -name __pycache__ \) -prune -o -type f -printf '%h\n' |
    sort | uniq -c | awk '$1 > 40 { print substr($2, 3) "/: " $1 " files, want at most 40" }')
  [[ -z $crowded ]] || fault "$crowded"
}

# The overview of a folder is its README.md, or the opening of its main file. Public headers open
# with their own path, so that excerpts tell where they live.
check_overviews() {
  say "overviews"
  local folder header rooms=(base geometry optimizer methods partition render wire io jobs picture calls server)
  for folder in "${rooms[@]}" proto cli python fuzz bench tests examples docs scripts; do
    [[ -d $folder ]] || continue
    [[ -e $folder/README.md ]] ||
      grep -rlsE "^(//|#) $folder/ : |^// $folder/[a-z_]+\.h : " "$folder" >/dev/null ||
      fault "$folder/: no overview; write $folder/README.md, or open its main header with" \
        "\"// $folder/NAME.h : what it is\""
  done
  while read -r header; do
    head -n 1 "$header" | grep -q "^// $header\b" ||
      fault "$header:1: want the first line to be \"// $header\""
  done < <(find "${rooms[@]}" -name '*.h' | sort)
}

# What is quoted with its command can be run by it.
check_benchmarks() {
  say "benchmarks"
  local name
  while read -r name; do
    benchmarks | grep -qx "$name" || fault "./run bench $name: is named in README.md or docs/, and is none"
  done < <(grep -ohE '\./run bench [a-z0-9_]+' README.md docs/*.md bench/README.md CHANGELOG.md |
    cut -d ' ' -f 3 | sort -u)
  while read -r name; do
    grep -q "^| \`bench_$name\`" bench/README.md || fault "bench/README.md: no row for bench_$name"
  done < <(benchmarks)
}

check_scripts() {
  say "shell scripts"
  shellcheck -x run .ci/run scripts/*.sh cmake/*.sh || fault "shellcheck is not content"
}

check_tidy() {
  say "clang-tidy"
  configure release +tests +python +bench
  build release >/dev/null  # the headers that it generates
  /usr/bin/python3 scripts/check_tidy.py "$(num_jobs)" || fault "clang-tidy is not content"
}

checks=(layout layers overviews benchmarks scripts tidy)
if (($#)); then
  for check in "$@"; do
    [[ $check =~ ^(layout|layers|overviews|benchmarks|scripts|tidy)$ ]] ||
      die "lint \"$check\": want some of ${checks[*]}"
  done
  checks=("$@")
fi
need_packages packages.txt packages-test.txt packages-bench.txt packages-lint.txt
for check in "${checks[@]}"; do "check_$check"; done
((num_faults == 0)) || die "lint: $num_faults faults, see above"
say "lint: no faults, $SECONDS s"
