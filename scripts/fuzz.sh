#!/usr/bin/env bash
# ./run fuzz : feeds the parsers of fuzz/ with what libFuzzer makes of their corpora.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/common.sh
source scripts/common.sh

usage() {
  cat <<'END'
usage: ./run fuzz [TARGET...] [--seconds N] [--jobs N]
       ./run fuzz [TARGET...] --minimize

Runs every target, or those named, for N seconds (60) each, a few at a time. Ends with 1 when there
is a finding: a crash, a sanitizer's report, a broken promise (fuzz/promises.h), more than 10 seconds
or 2 GB for one input. What was found and what was learnt stays in out/fuzz/TARGET/.

--minimize keeps in fuzz/corpus/TARGET/ what has a name, and of all other inputs there and in
out/fuzz/TARGET/corpus/ those few that reach most.
END
}

max_input_bytes=65536
max_corpus_bytes=80000  # of each target's inputs in the repository
limits=(-timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=1024 "-max_len=$max_input_bytes")

all_targets() { find fuzz/targets -name '*.cc' -printf '%f\n' | sed 's/\.cc$//' | sort; }

# dictionary TARGET: the option that names its words, if there are any.
dictionary() {
  local target=$1 words
  case $target in
    *_json) words=fuzz/json.dict ;;
    *) words=fuzz/$target.dict ;;
  esac
  [[ ! -e $words ]] || echo "-dict=$words"
}

# fuzz_target TARGET SECONDS: its log is out/fuzz/TARGET/log.
fuzz_target() {
  local target=$1 seconds=$2 folder=out/fuzz/$1 options=()
  mkdir -p "$folder/corpus" "fuzz/corpus/$target"
  mapfile -t options < <(dictionary "$target")
  nice "build/fuzz/bin/fuzz_$target" "${limits[@]}" "${options[@]}" "-max_total_time=$seconds" \
    -print_final_stats=1 "-artifact_prefix=$folder/" "$folder/corpus" "fuzz/corpus/$target" \
    >"$folder/log" 2>&1
}

# report TARGET: one line; 1 when there is a finding.
report() {
  local target=$1 folder=out/fuzz/$1 runs coverage inputs num_new finding words
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$folder/log")
  coverage=$(grep -aoE 'cov: [0-9]+' "$folder/log" | tail -n 1 | grep -aoE '[0-9]+' || true)
  num_new=$(sed -n 's/^stat::new_units_added: *//p' "$folder/log")
  inputs=$(find "fuzz/corpus/$target" -type f | wc -l)
  finding=$(grep -aoE "Test unit written to .*" "$folder/log" | sed 's/.* //' | tail -n 1 || true)
  printf '%-14s %9s runs  %6s edges  %4s inputs  %5s new' \
    "$target" "${runs:-?}" "${coverage:-?}" "$inputs" "${num_new:-?}"
  if [[ -z $finding ]] && grep -aq '^Done ' "$folder/log"; then
    echo
    return 0
  fi
  words=$(grep -a -m 1 -E '^SUMMARY|broken promise|ERROR: |run interrupted' "$folder/log" || tail -n 1 "$folder/log")
  printf '  FINDING\n    %s\n    log: %s\n' "$words" "$folder/log"
  if [[ -n $finding ]]; then
    echo "    again: build/fuzz/bin/fuzz_$target $finding"
    echo "    fixed: copy it to fuzz/corpus/$target/ under a name that says what it was"
  fi
  return 1
}

fuzz_all() {
  local seconds=$1 jobs=$2 target num_findings=0
  shift 2
  say "fuzzing $# targets for $seconds s each, $jobs at a time"
  for target in "$@"; do
    while (($(jobs -pr | wc -l) >= jobs)); do wait -n || true; done
    fuzz_target "$target" "$seconds" &
  done
  wait || true
  for target in "$@"; do
    report "$target" || num_findings=$((num_findings + 1))
  done
  ((num_findings == 0)) || die "fuzz: $num_findings findings, see above"
}

# Files whose names say what they are stay: first inputs and findings. libFuzzer names its own by
# their SHA-1, and writes those that reach most first.
minimize() {
  local target merged file bytes
  for target in "$@"; do
    say "minimizing fuzz/corpus/$target"
    mkdir -p "out/fuzz/$target/corpus" "fuzz/corpus/$target"
    merged=$(mktemp -d)
    # Edges alone count, not how often they are passed: a corpus for a repository.
    "build/fuzz/bin/fuzz_$target" "${limits[@]}" -set_cover_merge=1 -use_counters=0 "$merged" \
      "fuzz/corpus/$target" "out/fuzz/$target/corpus" 2>"out/fuzz/$target/merge.log" ||
      die "fuzz: an input stands in the way, see out/fuzz/$target/merge.log"
    bytes=0
    for file in "fuzz/corpus/$target"/*; do
      [[ -e $file ]] || continue
      if [[ ${file##*/} =~ ^[0-9a-f]{40}$ ]]; then
        rm "$file"
      else
        rm -f "$merged/$(sha1sum "$file" | cut -d ' ' -f 1)"
        bytes=$((bytes + $(stat -c %s "$file")))
      fi
    done
    while read -r file; do
      bytes=$((bytes + $(stat -c %s "$merged/$file")))
      ((bytes > max_corpus_bytes)) || mv "$merged/$file" "fuzz/corpus/$target/"
    done < <(find "$merged" -type f -printf '%T@ %f\n' | sort -n | cut -d ' ' -f 2)
    rm -r "$merged"
    echo "$(find "fuzz/corpus/$target" -type f | wc -l) inputs, $(du -bs "fuzz/corpus/$target")"
  done
}

seconds=60 jobs=$(num_jobs) action=fuzz_all targets=()
while (($#)); do
  case $1 in
    --seconds) seconds=${2:?"--seconds: want a number"} && shift ;;
    --jobs) jobs=${2:?"--jobs: want a number"} && shift ;;
    --minimize) action=minimize ;;
    -h | --help) usage && exit ;;
    -*) usage >&2 && die "fuzz: \"$1\" is no option" ;;
    *)
      [[ -e fuzz/targets/$1.cc ]] ||
        die "fuzz: \"$1\" is no target, want some of: $(all_targets | xargs)"
      targets+=("$1")
      ;;
  esac
  shift
done
((${#targets[@]})) || mapfile -t targets < <(all_targets)
[[ $seconds =~ ^[1-9][0-9]*$ && $jobs =~ ^[1-9][0-9]*$ ]] ||
  die "fuzz: want whole numbers above 0 for --seconds and --jobs"

need_packages packages.txt packages-fuzz.txt
configure fuzz -tests -python -bench
build fuzz "${targets[@]/#/fuzz_}" >/dev/null
case $action in
  fuzz_all) fuzz_all "$seconds" "$jobs" "${targets[@]}" ;;
  minimize) minimize "${targets[@]}" ;;
esac
