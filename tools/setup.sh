#!/bin/sh
# Makes sure that a Vulkan device can be found. Does nothing when there is one;
# otherwise installs the Vulkan loader and Mesa's software device (lavapipe)
# with apt. Run by `make demo` and `make test`; safe to run again.
set -eu

say() {
    printf 'setup: %s\n' "$*" >&2
}

# True if the dynamic linker finds the library named $1.
library_exists() {
    PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null | grep -qF "$1" && return 0
    old_ifs=$IFS
    IFS=:
    for folder in ${LD_LIBRARY_PATH:-}; do
        if [ -e "$folder/$1" ]; then
            IFS=$old_ifs
            return 0
        fi
    done
    IFS=$old_ifs
    return 1
}

# True if the driver manifest $1 names a library that exists. A manifest alone
# proves nothing: containers often carry one without its driver.
manifest_is_usable() {
    library=$(sed -n 's/.*"library_path"[[:space:]]*:[[:space:]]*"\([^"]*\)".*/\1/p' "$1" | head -n 1)
    case $library in
        '') return 1 ;;
        /*) [ -e "$library" ] ;;
        */*) [ -e "$(dirname "$1")/$library" ] ;;
        *) library_exists "$library" ;;
    esac
}

# The folders that the loader searches, one a line.
manifest_folders() {
    {
        printf '%s\n' "${XDG_CONFIG_HOME:-${HOME:-}/.config}"
        printf '%s\n' "${XDG_CONFIG_DIRS:-/etc/xdg}" | tr ':' '\n'
        printf '%s\n' /etc /usr/local/etc
        printf '%s\n' "${XDG_DATA_HOME:-${HOME:-}/.local/share}"
        printf '%s\n' "${XDG_DATA_DIRS:-/usr/local/share:/usr/share}" | tr ':' '\n'
    } | sed 's|/*$|/vulkan/icd.d|'
}

device_exists() {
    library_exists libvulkan.so.1 || return 1
    # Not piped into the loop: `return` would leave only the pipe's subshell.
    folders=$(manifest_folders)
    old_ifs=$IFS
    IFS='
'
    for folder in $folders; do
        for manifest in "$folder"/*.json; do
            if [ -r "$manifest" ] && manifest_is_usable "$manifest"; then
                IFS=$old_ifs
                return 0
            fi
        done
    done
    IFS=$old_ifs
    return 1
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    else
        sudo "$@"
    fi
}

apt_get() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o Dpkg::Use-Pty=0 "$@" >&2
}

# Reads apt's one-line sources and prints those of suite $1 for suite $2.
retarget_list() {
    awk -v from="$1" -v to="$2" '
        $1 == "deb" {
            suite = 3
            if ($2 ~ /^\[/) { while (suite <= NF && $(suite - 1) !~ /\]$/) suite++; suite++ }
            if ($suite == from && $0 ~ /[ \t]main([ \t]|$)/) {
                line = $1
                for (i = 2; i < suite; i++) line = line " " $i
                print line " " to " main"
            }
        }'
}

# Reads apt's deb822 sources and prints those of suite $1 for suite $2. A
# stanza is kept whole but for its suite, so that its key goes with it.
retarget_sources() {
    awk -v from="$1" -v to="$2" '
        function flush() {
            if (is_deb && has_suite && has_main && !is_off) printf "%s\n", stanza
            stanza = ""; is_deb = has_suite = has_main = is_off = 0
        }
        /^[ \t]*$/ { flush(); next }
        /^#/ { next }
        {
            field = tolower($1); words = " " $0 " "
            if (field == "types:") is_deb = words ~ / deb /
            if (field == "enabled:") is_off = tolower($2) ~ /^(no|false|0|off|without|disable)$/
            if (field == "suites:") { has_suite = index(words, " " from " ") > 0; $0 = "Suites: " to }
            if (field == "components:") { has_main = words ~ / main /; $0 = "Components: main" }
            stanza = stanza $0 "\n"
        }
        END { flush() }'
}

# Writes into folder $1 the machine's own package sources, and its archive's
# backports after them. Fails if the archive cannot be told.
write_backports_sources() {
    for file in /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources; do
        [ -r "$file" ] || continue
        cp "$file" "$1/"
        case $file in
            *.list) retarget_list "$codename" "$codename-backports" <"$file" >>"$1/backports.list" ;;
            *) retarget_sources "$codename" "$codename-backports" <"$file" >>"$1/backports.sources" ;;
        esac
    done
    if [ -r /etc/apt/sources.list ]; then
        retarget_list "$codename" "$codename-backports" </etc/apt/sources.list >>"$1/backports.list"
    fi
    find "$1" -name 'backports.*' -size 0 -delete
    [ -e "$1/backports.list" ] || [ -e "$1/backports.sources" ]
}

# Installs from the distribution's backports: Mesa 25 traces about twice as
# fast as the 22.3.6 of Debian 12. The extra source serves this install alone.
install_from_backports() {
    codename=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release | tr -d '"')
    [ -n "$codename" ] || return 1
    parts="$temporary/sources"
    mkdir "$parts"
    write_backports_sources "$parts" || return 1
    # apt drops to a user of its own, who must be able to read these.
    chmod -R a+rX "$temporary"
    apt_get -o Dir::Etc::SourceParts="$parts" update || return 1
    apt_get -o Dir::Etc::SourceParts="$parts" install -y --no-install-recommends \
        -t "$codename-backports" libvulkan1 mesa-vulkan-drivers
}

if [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
    # The caller has chosen a driver; the program reports it if it is unusable.
    exit 0
fi
if device_exists; then
    exit 0
fi

if ! command -v apt-get >/dev/null 2>&1; then
    say "no Vulkan device found, and this system has no apt-get:" \
        "install the Vulkan loader and a driver (Mesa's lavapipe needs no GPU)"
    exit 1
fi
if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null 2>&1; then
    say "no Vulkan device found: as root, run 'apt-get install libvulkan1 mesa-vulkan-drivers'"
    exit 1
fi

say "no Vulkan device found: installing the Vulkan loader and the software device lavapipe"
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

if ! install_from_backports; then
    say "Mesa cannot be had from backports: installing the stock package"
    apt_get update
    apt_get install -y --no-install-recommends libvulkan1 mesa-vulkan-drivers
fi
version=$(dpkg-query -W -f '${Version}' mesa-vulkan-drivers)
case $version in
    *~bpo*) say "installed Mesa $version from backports" ;;
    *) say "installed Mesa $version, the stock package" ;;
esac

if ! device_exists; then
    say "the packages are installed, but still no Vulkan driver is found"
    exit 1
fi
