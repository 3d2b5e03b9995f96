"""The machine that figures were measured on, named as dalembert names it in its reports; Python's standard library only."""
import pathlib
import subprocess

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin/dalembert"


def described(program=PROGRAM):
    """(kind, details): what tells machines apart on which times differ, and what else is known of this one."""
    kind, details = subprocess.run([str(program), "--machine"], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    return kind, details


def text(program=PROGRAM):
    """Both in a line."""
    return "{} ({})".format(*described(program))
