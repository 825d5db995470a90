"""`python -m robocell`: the command line."""

from robocell.cli import main

if __name__ == "__main__":
    main()
