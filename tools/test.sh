#!/usr/bin/env bash
# Installs what the tests need and passes them: format, lints, tests, documentation. Any failure ends it.
set -euo pipefail
cd "$(dirname "$0")/.."

step() {
    printf '\n==> %s\n' "$*"
    local start=$SECONDS
    "$@"
    printf '<== %s s\n' "$((SECONDS - start))"
}

step tools/setup-tests.sh
step cargo fmt --check
step cargo clippy --locked --all-targets -- -D warnings
step cargo test --locked
step env RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --document-private-items
printf '\nall passed in %s s\n' "$SECONDS"
