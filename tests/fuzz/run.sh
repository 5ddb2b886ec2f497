#!/usr/bin/env bash
# Fuzzes each target, or those named, for SECONDS_EACH (600) seconds: no crash, no input slower than 5 s, no more than 1 GB.
#   cargo install cargo-fuzz && tests/fuzz/run.sh obj ply
# No sanitizer: there is no unsafe code to look into, and without one any compiler will do. Finds are left in
# tests/fuzz/artifacts; a find becomes a test with a name of its own beside the reader's other tests.
set -euo pipefail
cd "$(dirname "$0")/../.."
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(obj off ply stl gltf glb xyz any landmarks settings warp whole command papers)
out=${OUT:-tests/fuzz}
mkdir -p "$out/logs"
cargo fuzz build --fuzz-dir tests/fuzz -s none
programs=${CARGO_TARGET_DIR:-tests/fuzz/target}/$(rustc -vV | sed -n 's/^host: //p')/release
for target in "${targets[@]}"; do
    mkdir -p "$out/corpus/$target" "$out/artifacts/$target"
    dictionary=()
    [ -f "tests/fuzz/dictionaries/$target" ] && dictionary=(-dict="tests/fuzz/dictionaries/$target")
    quiet=()
    # The whole command prints.
    case $target in command | papers) quiet=(-close_fd_mask=3) ;; esac
    seeds=()
    [ -d "tests/fuzz/seeds/$target" ] && seeds=("tests/fuzz/seeds/$target")
    (
        # The address space ends above what the program itself maps, so that no allocation passes 1 GB unseen.
        ulimit -v 1500000
        nice -n 10 "$programs/$target" "$out/corpus/$target" "${seeds[@]}" \
            -artifact_prefix="$out/artifacts/$target/" -max_total_time="${SECONDS_EACH:-600}" -timeout=5 \
            "${quiet[@]}" -rss_limit_mb=1024 -max_len=16384 -print_final_stats=1 "${dictionary[@]}"
    ) >"$out/logs/$target.log" 2>&1 && ended=well || ended=FOUND
    printf '%s: %s, ' "$target" "$ended"
    grep -aE '^stat::(number_of_executed_units|peak_rss_mb|slowest_unit)|^Done' "$out/logs/$target.log" | tr -s ' \n' ' '
    echo
done
