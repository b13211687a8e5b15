"""`python -m herijk` is `herijk`."""

from herijk.cli.main import main

if __name__ == "__main__":
    main()
