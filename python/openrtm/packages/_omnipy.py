"""What the stubs of omniidl import beside omniORB: those of omniidl 3.0 and of 4.x."""


def checkVersion(major, minor, file, *rest):
    if (major, minor) < (2, 0):
        raise ImportError("%s was made by omniidl %s.%s; run omniidl -bpython again" % (file, major, minor))


def invoke(object_, operation, descriptor, args):
    return object_._obj.invoke(operation, descriptor, args)
