"""Python as on Windows, for the modules of ltca, fem and validation alone: imported at the start with this folder on PYTHONPATH.

The standard library and other packages keep what Linux has. Our modules have no module and no name that Windows has not, spawn
processes, and lock files by a `msvcrt` whose locks are those of `fcntl.lockf`: of bytes, of one process, gone when it ends.
"""

from __future__ import annotations

import builtins
import importlib
import os
import sys
import time
import types
from pathlib import Path

MODULES = frozenset({"fcntl", "grp", "posix", "pty", "pwd", "resource", "spwd", "syslog", "termios", "tty"})


def _words(text):
    return frozenset(text.split())


NAMES = {
    "os": _words(
        """
        O_ASYNC O_CLOEXEC O_DIRECT O_DIRECTORY O_DSYNC O_NOCTTY O_NOFOLLOW O_NONBLOCK O_PATH O_SYNC O_TMPFILE P_ALL
        P_PGID P_PID SCHED_BATCH SCHED_FIFO SCHED_OTHER WCONTINUED WCOREDUMP WEXITED WEXITSTATUS WIFEXITED
        WIFSIGNALED WIFSTOPPED WNOHANG WSTOPSIG WTERMSIG WUNTRACED chown chroot confstr ctermid fchdir fchmod fchown
        fdatasync fork forkpty fpathconf fstatvfs getegid geteuid getgid getgrouplist getgroups getloadavg getpgid
        getpgrp getpriority getresgid getresuid getsid getuid getxattr initgroups killpg lchmod lchown listxattr
        lockf login_tty major makedev memfd_create minor mkfifo mknod nice openpty pathconf pidfd_open pipe2
        posix_fadvise posix_fallocate posix_openpt posix_spawn posix_spawnp pread preadv pwrite pwritev
        register_at_fork removexattr sched_getaffinity sched_getscheduler sched_setaffinity sched_yield sendfile
        setegid seteuid setgid setgroups setpgid setpriority setregid setresgid setresuid setreuid setsid setuid
        setxattr splice statvfs sync sysconf tcgetpgrp tcsetpgrp ttyname umount uname unshare wait wait3 wait4
        waitid
        """
    ),
    "signal": _words(
        """
        ITIMER_PROF ITIMER_REAL ITIMER_VIRTUAL SIGALRM SIGBUS SIGCHLD SIGCLD SIGCONT SIGHUP SIGIO SIGKILL SIGPIPE
        SIGPOLL SIGPROF SIGPWR SIGQUIT SIGRTMAX SIGRTMIN SIGSTKFLT SIGSTOP SIGSYS SIGTRAP SIGTSTP SIGTTIN SIGTTOU
        SIGURG SIGUSR1 SIGUSR2 SIGVTALRM SIGWINCH SIGXCPU SIGXFSZ SIG_BLOCK SIG_SETMASK SIG_UNBLOCK alarm getitimer
        pause pidfd_send_signal pthread_kill pthread_sigmask setitimer siginterrupt sigpending sigtimedwait sigwait
        sigwaitinfo
        """
    ),
    "select": _words(
        """
        devpoll epoll kevent kqueue poll
        """
    ),
    "socket": _words(
        """
        AF_UNIX CMSG_LEN CMSG_SPACE recv_fds send_fds
        """
    ),
    "time": _words(
        """
        tzset
        """
    ),
    "multiprocessing": _words(
        """
        forkserver popen_fork popen_forkserver
        """
    ),
}
"""What the documentation of Python marks "Availability: Unix" or "not Windows", by its module."""
ROOT = Path(__file__).resolve().parents[2]
OURS = ("ltca", "fem", "validation")


class _Proxy(types.ModuleType):
    """A module without the names that Windows has not, and with others of its own."""

    def __init__(self, module, **instead):
        super().__init__(module.__name__)
        self.__dict__.update(instead)
        self._module, self._missing = module, NAMES.get(module.__name__, frozenset())

    def __getattr__(self, name):
        if name in self._missing:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r} (as on Windows)")
        return getattr(self._module, name)


def _locking(descriptor, mode, count):
    import fcntl

    place = os.lseek(descriptor, 0, os.SEEK_CUR)
    for trial in range(10 if mode == 1 else 1):
        time.sleep(0.2 if trial else 0.0)
        try:
            fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, count, place)
        except BlockingIOError:
            continue
        return
    raise PermissionError(13, "Permission denied") if mode == 2 else OSError(35, "Resource deadlock avoided")


def _instead():
    import multiprocessing
    import select
    import signal
    import socket

    msvcrt = types.SimpleNamespace(LK_LOCK=1, LK_NBLCK=2, locking=_locking)

    def import_module(name, package=None):
        return msvcrt if name == "msvcrt" else importlib.import_module(name, package)

    def get_context(method=None):
        if method not in (None, "spawn"):
            raise ValueError(f"cannot find context for {method!r}")
        return multiprocessing.get_context("spawn")

    return {
        "os": _Proxy(os, name="nt"),
        "signal": _Proxy(signal),
        "select": _Proxy(select),
        "socket": _Proxy(socket),
        "time": _Proxy(time),
        "importlib": _Proxy(importlib, import_module=import_module),
        "multiprocessing": _Proxy(multiprocessing, get_all_start_methods=lambda: ["spawn"], get_context=get_context),
    }


def _is_ours(importer):
    name = importer.get("__name__", "").partition(".")[0]
    if name in OURS:
        return True
    file = importer.get("__file__") or ""
    return name == "__main__" and any(Path(file).resolve().is_relative_to(ROOT / one) for one in OURS)


def install():
    """Let our modules import what Windows has."""
    real, instead = builtins.__import__, {}

    def imported(name, globals=None, locals=None, fromlist=(), level=0):  # noqa: A002  # those of __import__
        if level or not globals or not _is_ours(globals):
            return real(name, globals, locals, fromlist, level)
        if name.partition(".")[0] in MODULES or name == "multiprocessing.forkserver":
            raise ModuleNotFoundError(f"No module named {name!r} (as on Windows)", name=name)
        if not instead:
            instead.update(_instead())
        found = real(name, globals, locals, fromlist, level)
        proxy = instead.get(found.__name__)
        if proxy is None:
            return found
        missing = sorted(proxy._missing & set(fromlist or ()))
        if missing:
            raise ImportError(f"cannot import name {missing[0]!r} from {name!r} (as on Windows)")
        return proxy

    builtins.__import__ = imported


if __name__ == "sitecustomize":
    install()
elif __name__ == "__main__":
    sys.exit("is imported by the start of Python")
