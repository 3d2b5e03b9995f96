"""Pictures of the examples, drawn without a screen where matplotlib is installed (Debian: python3-matplotlib)."""

import pathlib
import sys


def draw(name, plot):
    """Calls plot(pyplot), and saves what it drew as NAME.svg in the folder that the program's first argument names, or here."""
    try:
        import matplotlib
        matplotlib.use("svg")
        from matplotlib import pyplot
    except ImportError:
        print("without matplotlib there is no picture")
        return
    pyplot.figure(figsize=(7, 4))
    plot(pyplot)
    pyplot.tight_layout()
    file = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".") / f"{name}.svg"
    pyplot.savefig(file)
    print("drawn:", file)
