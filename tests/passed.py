"""What has passed and need not be compiled again, on another machine either: a file of a line each, in the repository for the long run."""
import pathlib
import threading


class Passed:
    """Per number of a cell or case: a digest of all that its outcome depends on, and the outcome, a word."""

    def __init__(self, path):
        self.path, self.lock = pathlib.Path(path), threading.Lock()
        lines = self.path.read_text().splitlines() if self.path.exists() else []
        self.known = {int(number): (digest, outcome) for number, digest, outcome in map(str.split, lines)}

    def outcome(self, number, digest):
        """None where it is not known, or was of something else."""
        known = self.known.get(number)
        return known[1] if known and known[0] == digest else None

    def add(self, number, digest, outcome):
        with self.lock:
            self.known[number] = (digest, outcome)

    def write(self):
        """As a whole or not at all: a run may be stopped at any time."""
        with self.lock:
            lines = [f"{number} {digest} {outcome}\n" for number, (digest, outcome) in sorted(self.known.items())]
            new = self.path.with_suffix(".new")
            new.write_text("".join(lines))
            new.replace(self.path)
