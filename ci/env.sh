# Sourced by the scripts of ci/: one place for the environment that builds and tests share.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$(dirname "$root")}" CCACHE_NOHASHDIR=1
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
# Recordings that this project does not ship are looked for beside the checkout unless told where.
if [ -z "${TOUCHSTONE_DATA_DIR:-}" ] && [ -d "$root/../shared/data" ]; then
  TOUCHSTONE_DATA_DIR=$(cd "$root/../shared/data" && pwd)
fi
export TOUCHSTONE_DATA_DIR="${TOUCHSTONE_DATA_DIR:-}"
