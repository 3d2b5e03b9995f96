"""What code under test is made of, so that what has passed once need not be compiled again."""
import hashlib
import pathlib
import re

RUNTIME = pathlib.Path(__file__).resolve().parents[1] / "runtime/include"


def digest(files, runtime=RUNTIME):
    """Of files of a generated folder and the runtime's headers that they include, however far down."""
    seen, todo = {}, [pathlib.Path(file) for file in files]
    while todo:
        file = todo.pop()
        if file not in seen:
            seen[file] = file.read_bytes()
            todo += [runtime / name for name in re.findall(r'#include [<"](dalembert/[\w/]+\.hpp)[>"]', seen[file].decode())]
    return hashlib.sha256(b"".join(seen[file] for file in sorted(seen))).hexdigest()
