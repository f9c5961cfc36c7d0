"""Back end of omniidl: Python stubs and skeletons (`omniidl -bpython FILE.idl`).

FILE.idl becomes FILE_idl.py. Each IDL module M becomes the packages M and M__POA, which import all stub files that add to M.
"""
import os
import sys

# omniidl imports this file as omniidl_be.python when it is installed, as python from a folder of PYTHONPATH.
if __package__:
    from .rtmsim_python import example, packages, stub as stubs
else:
    from rtmsim_python import example, packages, stub as stubs

cpp_args = ["-D__OMNIIDL_PYTHON__"]
usage_string = """\
  -Wbstdout       Write the stubs to stdout instead of files
  -Wbinline       Put included files into the same stub file
  -Wbexample      Write FILE_idl_example.py, a servant to fill in
  -Wbglobal=NAME  Module for definitions outside of IDL modules (default _GlobalIDL)
  -Wbpackage=NAME Put the packages into this package
  -Wbmodules=NAME Put the packages of modules into this package
  -Wbstubs=NAME   Put the stub files into this package
  -Wbextern=NAME  Do not import the stubs of this included file, or of NAME:PACKAGE from that package
  -Wbno_package   Write no packages for modules
  -Wblater        Packages load a stub file when one of its names is used
  -Wbclosed       Type checkers refuse names that no stub file has"""


class Options:
    def __init__(self, args):
        self.stdout = self.inline = self.example = self.no_package = self.later = self.closed = False
        self.global_module = "_GlobalIDL"
        self.modules = self.stubs = ""
        self.extern = {}
        for arg in args:
            name, _, value = arg.partition("=")
            if arg in ("stdout", "inline", "example", "no_package", "later", "closed"):
                setattr(self, arg, True)
            elif name == "global" and value:
                self.global_module = value
            elif name == "package":
                self.modules = self.stubs = value + "." if value else ""
            elif name == "modules":
                self.modules = value + "." if value else ""
            elif name == "stubs":
                self.stubs = value + "." if value else ""
            elif name == "extern" and value:
                file, _, package = value.partition(":")
                self.extern[file] = package
            elif arg not in ("factories", "ami"):
                sys.stderr.write("omniidl: warning: the Python back end has no option -Wb%s\n" % arg)


def run(tree, args):
    options = Options(args)
    stub = stubs.Stub(tree, options)
    text = stub.text()
    if options.stdout:
        sys.stdout.write(text)
        return
    folder = options.stubs.replace(".", "/")
    packages.make_folder(folder)
    with open(os.path.join(folder, stub.module + ".py"), "w") as out:
        out.write(text)
    if not options.no_package:
        for name in stub.modules_seen:
            packages.write_package(options, name, stub, False)
            packages.write_package(options, name, stub, True)
    if options.example:
        with open(stub.module + "_example.py", "w") as out:
            out.write(example.example(tree, stub))
