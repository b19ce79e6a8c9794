"""Where the command `explicable` begins, as does `python -m explicable`."""

import os
import signal


def main() -> None:
    """Import the command line and run it; Ctrl-C meanwhile ends the process with the usual exit code."""
    # An exception would show a traceback, or get lost in a callback of the import system. Nothing has begun
    # that would have to be tidied up. Where whoever started the command ignores Ctrl-C, that stays so.
    noticed = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if noticed:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    from explicable.cli import main as run_command

    if noticed:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    run_command()


if __name__ == "__main__":
    main()
