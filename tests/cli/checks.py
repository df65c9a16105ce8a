"""What the scripts that check the program share: its one option, and the last words."""
import argparse
import os


def program(description):
    """The absolute path that --program names."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    return os.path.abspath(parser.parse_args().program)


def verdict(summary, failures):
    """Prints the failures and a line that counts them; the exit code."""
    for failure in sorted(failures):
        print("FAILED", failure)
    print(f"{summary}; {len(failures)} failures")
    return 1 if failures else 0
