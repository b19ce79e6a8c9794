"""`python -m explicable` is the command `explicable`."""

from explicable.cli import main

if __name__ == "__main__":
    main()
