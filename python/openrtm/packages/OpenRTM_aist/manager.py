"""The manager of this process."""
import atexit
import os
import sys

import _openrtm_core as _core
import RTC

from . import host
from .logger import Logger

__all__ = ["Manager", "Delete", "Factory", "FactoryPython", "ManagerActionListener", "ModuleActionListener", "RtcLifecycleActionListener",
           "NamingActionListener"]


def Delete(component):
    """The third argument of registerFactory: the runtime deletes components itself."""


class Factory:
    pass


FactoryPython = Factory


class ManagerActionListener:
    """A listener has those of these methods that it wants."""

    def preShutdown(self):
        pass

    def postShutdown(self):
        pass

    def preReinit(self):
        pass

    def postReinit(self):
        pass


class ModuleActionListener:
    def preLoad(self, modname, funcname):
        pass

    def postLoad(self, modname, funcname):
        pass

    def preUnload(self, modname):
        pass

    def postUnload(self, modname):
        pass


class RtcLifecycleActionListener:
    def preCreate(self, args):
        pass

    def postCreate(self, rtobj):
        pass

    def preConfigure(self, prop):
        pass

    def postConfigure(self, prop):
        pass

    def preInitialize(self):
        pass

    def postInitialize(self):
        pass


class NamingActionListener:
    def preBind(self, rtobj, name):
        pass

    def postBind(self, rtobj, name):
        pass

    def preUnbind(self, rtobj, name):
        pass

    def postUnbind(self, rtobj, name):
        pass


class _Teller:
    """Calls the method of the listener that has the event's name, until the listener is removed."""

    def __init__(self, listener):
        self.listener = listener

    def __call__(self, event, *args):
        method = getattr(self.listener, event, None)
        if method is not None:
            method(*args)


class Manager:
    """Loads modules, makes, connects and deletes components. One per process."""
    _instance = None

    def __init__(self):
        self._tellers = []

    @staticmethod
    def init(*args):
        """The manager, started with the words of a command line: init(argv), also init(argc, argv)."""
        if Manager._instance is None:
            argv = list(args[-1]) if args and args[-1] is not None else []
            Manager._start(argv, False, [])
        return Manager._instance

    @staticmethod
    def instance():
        return Manager.init([])

    @staticmethod
    def _start(argv, is_host, modules):
        import signal
        import threading
        words = [str(word) for word in argv] or [sys.argv[0] if sys.argv else "python3"]
        # The runtime ends the process on Ctrl-C, unless the author has a handler: Python's own would wait for bytecode of the main thread.
        if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        sys.setswitchinterval(1e-4)
        _core.manager_init(words, is_host, modules, host.load)
        Manager._instance = Manager()
        host.prepare()

    # --- life

    # A module that calls its main() while a host loads it wants its components only: the host runs the manager.
    def setModuleInitProc(self, proc):
        if host.is_loading():
            host.set_init_function(proc)
        else:
            _core.manager_set_init_function(lambda: proc(self))

    def activateManager(self):
        return True if host.is_loading() else _core.manager_activate()

    def runManager(self, no_block=None):
        if not host.is_loading():
            _core.manager_run(bool(no_block))

    def shutdown(self):
        _core.manager_shutdown()

    def terminate(self):
        _core.manager_terminate()

    def join(self):
        _core.manager_join()

    # --- modules

    def load(self, fname, initfunc=""):
        return _code(_core.manager_load(fname, initfunc or ""))

    def unload(self, fname):
        return _code(_core.manager_unload(fname))

    def unloadAll(self):
        for module in self.getLoadedModules():
            self.unload(module.getProperty("file_path"))

    def getLoadedModules(self):
        return _core.manager_loaded_modules()

    def getLoadableModules(self):
        return _core.manager_loadable_modules()

    def getFactoryProfiles(self):
        return _core.manager_factory_profiles()

    def getModulesFactories(self):
        return [one.getProperty("implementation_id") for one in self.getFactoryProfiles()]

    # --- components

    def registerFactory(self, profile, new_func, delete_func=None):
        if not isinstance(profile, _core.Properties):
            return self._refuse("registerFactory: expected Properties(defaults_str=...), got %s", _kind(profile))
        if not _makes(new_func, _core.Component):
            return self._refuse("registerFactory(%r): expected a class of a component or a function that makes one, got %s",
                                profile.getProperty("implementation_id"), _kind(new_func))
        return _core.manager_register_factory(profile, lambda: new_func(self))

    def createComponent(self, comp_args):
        """The component, or None: the log says why. `Type`, `Type?key=value&key=value`."""
        return _core.manager_create_component(comp_args)

    def deleteComponent(self, instance_name=None, comp=None):
        name = comp.getInstanceName() if comp is not None else instance_name
        if not isinstance(name, str):
            name = name.getInstanceName()
        return _code(_core.manager_delete_component(name))

    def getComponent(self, instance_name):
        return _core.manager_component(instance_name)

    def getComponents(self):
        return _core.manager_components()

    def connectPorts(self, text):
        _core.manager_connect(text)

    # --- listeners

    def addManagerActionListener(self, listener, autoclean=True):
        self._listen(_core.manager_add_manager_listener, listener)

    def addModuleActionListener(self, listener, autoclean=True):
        self._listen(_core.manager_add_module_listener, listener)

    def addRtcLifecycleActionListener(self, listener, autoclean=True):
        self._listen(_core.manager_add_lifecycle_listener, listener)

    def addNamingActionListener(self, listener, autoclean=True):
        self._listen(_core.manager_add_naming_listener, listener)

    def _listen(self, add, listener):
        teller = _Teller(listener)
        add(teller)
        self._tellers.append(teller)

    def _forget(self, listener):
        for teller in self._tellers:
            if teller.listener is listener:
                teller.listener = None

    removeManagerActionListener = removeModuleActionListener = removeRtcLifecycleActionListener = removeNamingActionListener = _forget

    # --- the rest

    def registerECFactory(self, name, new_func, delete_func=None):
        """Components may name the context in execution_contexts or exec_cxt.periodic.type from now on."""
        from .contexts import ExecutionContextFactory, _Context
        if not _makes(new_func, _Context):
            return self._refuse("registerECFactory(%r): expected a class of an execution context or a function that makes one, got %s",
                                name, _kind(new_func))
        return ExecutionContextFactory.instance().addFactory(name, new_func, delete_func) == ExecutionContextFactory.FACTORY_OK

    def _refuse(self, message, *values):
        self.getLogbuf().RTC_ERROR(message, values)
        return False

    def isRunning(self):
        return _core.manager_is_running()

    def getConfig(self):
        return _core.manager_config()

    _config = property(getConfig)

    def getLogbuf(self, name="manager"):
        return Logger(name)

    def getORB(self):
        from omniORB import CORBA
        return CORBA.ORB_init()

    theORB = getORB

    def getPOA(self):
        from omniORB import PortableServer
        return PortableServer.root_poa()

    thePOA = getPOA

    def getPOAManager(self):
        return self.getPOA().the_POAManager

    thePOAManager = getPOAManager

    def getNaming(self):
        return _Naming()

    def getManagerServant(self):
        """The CORBA object of this manager: the operations of RTM.Manager, and getObjRef(). None if manager.corba_servant is NO, and when
        the manager ends."""
        reference = _core.manager_reference()
        return None if reference is None else _ManagerServant(reference)

    def addTask(self, function, period, delay=0):
        return _core.manager_add_task(function, _seconds(period), _seconds(delay))

    def removeTask(self, task):
        return _core.manager_remove_task(task)

    def invoke(self, function, delay=0):
        _core.manager_invoke(function)

    def __getattr__(self, name):
        raise AttributeError("Manager.%s is not part of this implementation (docs/python-components.md lists what is)" % name)


class _ManagerServant:
    def __init__(self, reference):
        self._reference = reference

    def getObjRef(self):
        return self._reference

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._reference, name)


class _Naming:
    def string_to_component(self, name):
        """The components of an instance name, of rtcname://HOST:PORT/PATH, or rtcloc://HOST:PORT/CATEGORY/INSTANCE."""
        return _core.manager_string_to_components(name)

    def bindObject(self, name, object_):
        _core.manager_bind_object(name, object_.getObjRef() if hasattr(object_, "getObjRef") else object_)


# A class must be derived from the base; what a function makes is seen when it is called.
def _makes(new_func, base):
    return issubclass(new_func, base) if isinstance(new_func, type) else callable(new_func)


def _kind(value):
    return "the class " + value.__name__ if isinstance(value, type) else type(value).__name__


def _code(number):
    return RTC.ReturnCode_t._item(number)


def _seconds(value):
    return float(value.toDouble()) if hasattr(value, "toDouble") else float(value)


# Before the interpreter is finalized no thread of the runtime may need it.
@atexit.register
def _end():
    if Manager._instance is not None and _core.manager_exists():
        _core.manager_shutdown()
    sys.stdout.flush()
    _core.close_doors()
