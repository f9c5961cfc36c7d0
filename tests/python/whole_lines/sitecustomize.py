# Python runs this file first where its folder is in PYTHONPATH: print() writes a line at once, so threads of a test program do not break each other's lines.
import builtins
import io

parts = builtins.print


def whole(*words, sep=None, end=None, file=None, flush=False):
    line = io.StringIO()
    parts(*words, sep=sep, end=end, file=line)
    parts(line.getvalue(), end="", file=file, flush=flush)


builtins.print = whole
