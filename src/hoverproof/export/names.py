"""Names that a firmware package cannot have.

The name stands alone in three places: as a header (``NAME.h``, in a folder that compilers search
before their own), as a library, and as a target of CMake. Everywhere else it is the beginning of a
longer name. What is taken there, and the words of C and C++, are refused whatever the case: some
file systems know no case, and include guards are in capitals.
"""

from __future__ import annotations

import re

from hoverproof.errors import InputError

LONGEST = 20

WORDS = """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t
    char32_t class co_await co_return co_yield compl complex concept const const_cast consteval
    constexpr constinit continue decltype default delete do double dynamic_cast else enum explicit
    export extern false far float for friend goto if imaginary import inline int interrupt long
    module mutable namespace near new noexcept noreturn not not_eq nullptr operator or or_eq private
    protected public register reinterpret_cast requires restrict return short signed sizeof static
    static_assert static_cast struct switch template this thread_local throw true try typedef typeid
    typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor
    xor_eq
"""
"""Words of C, of C++ (the adapters are C++) and of compilers for small processors."""

HEADERS = """
    aio alloca assert complex cpio ctype dirent dlfcn endian errno fcntl features fenv float fmtmsg
    fnmatch ftw getopt glob grp iconv inttypes iso646 langinfo libgen limits locale malloc math
    mathcalls memory monetary mqueue ndbm netdb newlib nl_types poll process pthread pwd reent regex
    sched search semaphore setjmp signal spawn stdalign stdarg stdatomic stdbit stdbool stdckdint
    stddef stdint stdio stdlib stdnoreturn string strings stropts syslog tar termios tgmath threads
    time trace uchar ulimit unistd utime utmpx varargs wchar wctype windows wordexp
    arm_acle arm_fp16 arm_neon arm_mve core_cm0 core_cm3 core_cm4 core_cm7 cmsis_gcc float_h io
    crtdefs corecrt vcruntime sal intrin errno_t sysmacros types assertions
    algorithm array atomic bitset cassert cmath cstddef cstdint cstdio cstdlib cstring exception
    functional iterator list map memory new set tuple utility vector version
"""
"""Headers of the C, POSIX and C++ libraries, of compilers, and of processors; the package's own
folder comes first when they are sought."""

SURROUNDINGS = """
    all build clean cmake cmakefiles cmakelists depend edit_cache example fly help install package
    package_source rebuild_cache run_tests test zero_check all_build list_install_components
    preinstall c m gcc g supc rt dl pthread util stdc
    adapters camera loop main manifest readme selftest vehicle vector hoverproof
    controller controller_pid stabilizer_types stabilizer config cfassert debug log param app
    app_channel supervisor
    ardupilot crazyflie px4 drivers uorb ap_common ap_hal ap_math ap_param
    ap_inertialsensor     ac_customcontrol ac_customcontrol_backend ac_customcontrol_config
"""
"""Targets of CMake, libraries, what the package itself has, and what its adapters include."""

TAKEN = frozenset(f"{WORDS} {HEADERS} {SURROUNDINGS}".split())


def package_name(name: str | None, mission: str) -> str:
    """Return the name of a package.

    Parameters
    ----------
    name : str or None
        The user's; by default made of that of the mission, cut short if it is long, with ``m_``
        before one that is taken.
    mission : str
        Name of the mission.

    Raises
    ------
    InputError
        If it is no C identifier of up to 20 characters, or taken by C or by what surrounds a
        package.
    """
    chosen = name if name is not None else re.sub(r"\W", "_", mission, flags=re.A).lower()
    if name is None:
        chosen = chosen[:LONGEST] if chosen[0].isalpha() else f"m{chosen}"[:LONGEST]
        if chosen.lower() in TAKEN:
            chosen = f"m_{chosen}"[:LONGEST]
    if not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST - 1}}}", chosen, re.A):
        reason = f"must be a C identifier of up to {LONGEST} characters, not {chosen!r}"
        raise InputError("--name", "", reason)
    if chosen.lower() in TAKEN:
        reason = (
            f"{chosen!r} is taken: a word of C or C++, a header, a library, a target of CMake or "
            f"a part of the package; 'm_{chosen}' is free"
        )
        raise InputError("--name", "", reason)
    return chosen
