#!/bin/bash
# Fuzzes every reader under AddressSanitizer and UndefinedBehaviorSanitizer: tools/fuzz.sh [SECONDS each, 600] [TARGET …]
# Findings are left in build/fuzz/findings; put one into tests/regress as <target>-<what it was> and fix the reader.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-600}
shift || true
CXX=${CXX:-clang++-14} cmake --preset fuzz > /dev/null
cmake --build --preset fuzz --target fuzzers
build=build/fuzz
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(cyhair pelage tressfx tressfx3 usc mesh_obj mesh_ply mesh_glb mesh_tfxmesh hair_mesh hair_mesh_text scene
                               image_png image_jpeg image_exr image_hdr)
$build/tests/fuzz/fuzz_corpus $build/corpus
mkdir -p $build/findings
status=0
for target in "${targets[@]}"; do
  mkdir -p $build/corpus/$target
  seeds=(tests/regress/inputs/$target-*)
  [ -e "${seeds[0]}" ] && cp "${seeds[@]}" $build/corpus/$target/
  log=$build/findings/$target.log
  # One thread: the readers' own parallelism would only slow tiny inputs down.
  if UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 nice $build/tests/fuzz/fuzz_$target -max_total_time=$seconds \
      -max_len=8192 -rss_limit_mb=1024 -timeout=25 -artifact_prefix=$build/findings/$target- $build/corpus/$target > $log 2>&1; then
    echo "$target: $(grep -o 'Done.*' $log | tail -1)"
  else
    echo "$target: FINDING, see $log"
    status=1
  fi
done
exit $status
