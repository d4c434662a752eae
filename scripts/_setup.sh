# Sourced by demo, test and check: leaves a ready .venv in $venv, or says what is missing and exits.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$root/.venv
cd "$root"

fail() {
    printf '%s\n' "$@" >&2
    exit 1
}

# Newest supported interpreter, or $PYTHON where that is set.
find_python() {
    local candidate
    for candidate in ${PYTHON:-python3.12 python3.11 python3.13 python3.10 python3}; do
        if "$candidate" -c 'import sys; sys.exit(not (3, 10) <= sys.version_info < (3, 14))' \
            2>/dev/null; then
            printf '%s\n' "$candidate"
            return
        fi
    done
    fail "JFTO needs Python 3.10 to 3.13; $(python3 --version 2>&1 || true) was found." \
        "Install one, or name it: PYTHON=/path/to/python3.12 $0"
}

# Debian and Ubuntu split venv from Python.
need_venv_module() {
    "$1" -c 'import ensurepip, venv' 2>/dev/null && return
    local version
    version=$("$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    fail "Python $version has no venv module. Install the system package and run this again:" \
        "    sudo apt install python$version-venv"
}

# Extras to install: the wheels of ROS 2 only where no ROS 2 is sourced, since two do not mix.
extras() {
    if "$1" -c 'import rclpy' 2>/dev/null; then
        printf 'bench,dev\n'
    else
        printf 'bench,dev,ros\n'
    fi
}

# What the installed set depends on: declared requirements, pins, where it lies, which ROS 2 there is.
wanted_stamp() {
    { printf '%s\n' "$root" "${AMENT_PREFIX_PATH:-}"; cat setup.cfg setup.py pyproject.toml constraints.txt; } |
        sha256sum | cut -d ' ' -f 1
}

# The numeric kernels are compiled on first use and kept beside the source. Done here once, no
# program that runs against the clock is held up by it; the doctor also loads every library.
compile_kernels() {
    "$venv/bin/python" -m compileall -q src
    "$venv/bin/jfto" doctor --compile
}

set_up() {
    local python extras log begin seconds
    python=$(find_python)
    need_venv_module "$python"
    begin=$SECONDS
    log=$venv/setup.log
    printf 'Setting up .venv (once; log in .venv/setup.log) … '
    extras=$(extras "$python")
    # A .venv that an interrupted run left half made cannot even start pip; one with the wheels of
    # ROS 2 is not for a shell that has sourced another.
    "$venv/bin/python" -m pip --version >/dev/null 2>&1 || rm -rf "$venv"
    case $extras in
        *ros*) ;;
        *) ! compgen -G "$venv/lib/python3*/site-packages/ros_rclpy-*" >/dev/null || rm -rf "$venv" ;;
    esac
    [ -d "$venv" ] || "$python" -m venv "$venv" || fail "" "$python could not make $venv."
    rm -f "$venv/stamp"
    if ! "$venv/bin/python" -m pip install --disable-pip-version-check --quiet \
        --constraint constraints.txt --editable ".[$extras]" >"$log" 2>&1; then
        fail "failed." "$(grep -iE '^ *error' "$log" | tail -n 5)" \
            "Check the network connection and the log .venv/setup.log, then run this again."
    fi
    compile_kernels >>"$log" 2>&1 || fail "failed." "$(tail -n 8 "$log")" \
        "The installed program does not run; the log is .venv/setup.log."
    wanted_stamp >"$venv/stamp"
    seconds=$((SECONDS - begin))
    printf '%d min %02d s\n' $((seconds / 60)) $((seconds % 60))
}

if [ "$(cat "$venv/stamp" 2>/dev/null)" != "$(wanted_stamp)" ] || [ ! -x "$venv/bin/jfto" ]; then
    set_up
fi
