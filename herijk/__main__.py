"""`python -m herijk` is `herijk`."""

from herijk.cli import main

if __name__ == "__main__":
    main()
