"""A naming service, by names as text."""
import CosNaming
from omniORB import CORBA, URI


class CorbaNaming:
    """CorbaNaming(orb, "host:port"): names are written as "a.host_cxt/X0.rtc"."""

    def __init__(self, orb, name_server=None):
        self._orb = orb
        self._root = None
        self._name_server = name_server
        if name_server:
            self.init(name_server)

    def init(self, name_server):
        if ":" not in name_server:
            name_server += ":2809"
        object_ = self._orb.string_to_object("corbaloc::%s/NameService" % name_server)
        self._root = object_._narrow(CosNaming.NamingContextExt) or object_._narrow(CosNaming.NamingContext)

    def isAlive(self):
        try:
            return self._root is not None and not self._root._non_existent()
        except CORBA.SystemException:
            return False

    def toName(self, text):
        return URI.stringToName(text) if isinstance(text, str) else text

    def toString(self, name):
        return URI.nameToString(name)

    def getRootContext(self):
        return self._root

    @property
    def _rootContext(self):
        return self._root

    def resolve(self, name):
        return self._root.resolve(self.toName(name))

    resolveStr = resolveByString = resolve

    def bind(self, name, object_, force=True):
        try:
            self._root.bind(self.toName(name), object_)
        except CosNaming.NamingContext.NotFound:
            if not force:
                raise
            self._make_contexts(self.toName(name))
            self._root.bind(self.toName(name), object_)

    bindByString = bind

    def bindRecursive(self, context, name, object_):
        """Binds below the context, and makes the contexts of the name that are missing."""
        self._recursive(context, self.toName(name), "bind", object_)

    def rebindRecursive(self, context, name, object_):
        self._recursive(context, self.toName(name), "rebind", object_)

    def bindContext(self, name, context, force=True):
        self._root.bind_context(self.toName(name), context)

    bindContextByString = bindContext

    def rebindContext(self, name, context, force=True):
        self._root.rebind_context(self.toName(name), context)

    rebindContextByString = rebindContext

    def bindOrResolve(self, context, name, object_):
        """The object that has the name; this one, if none has it yet."""
        try:
            context.bind(name, object_)
            return object_
        except CosNaming.NamingContext.AlreadyBound:
            return context.resolve(name)

    def bindOrResolveContext(self, context, name, new_context=None):
        return self.bindOrResolve(context, name, self.newContext() if new_context is None else new_context)

    @staticmethod
    def _recursive(context, name, operation, object_):
        for part in name[:-1]:
            try:
                context = context.resolve([part])._narrow(CosNaming.NamingContext)
            except CosNaming.NamingContext.NotFound:
                context = context.bind_new_context([part])
        getattr(context, operation)(name[-1:], object_)

    def rebind(self, name, object_, force=True):
        try:
            self._root.rebind(self.toName(name), object_)
        except CosNaming.NamingContext.NotFound:
            if not force:
                raise
            self._make_contexts(self.toName(name))
            self._root.rebind(self.toName(name), object_)

    rebindByString = rebind

    def _make_contexts(self, name):
        for count in range(1, len(name)):
            try:
                self._root.bind_new_context(name[:count])
            except CosNaming.NamingContext.AlreadyBound:
                pass

    def unbind(self, name):
        self._root.unbind(self.toName(name))

    unbindByString = unbind

    def getNameServer(self):
        return self._name_server

    def destroy(self, context):
        context.destroy()

    @staticmethod
    def objIsNamingContext(object_):
        return object_._narrow(CosNaming.NamingContext) is not None

    def nameIsNamingContext(self, name):
        return self.objIsNamingContext(self.resolve(name))

    @staticmethod
    def subName(name, begin, end=None):
        return name[begin:] if end is None or end < 0 else name[begin:end + 1]

    def newContext(self):
        return self._root.new_context()

    def bindNewContext(self, name, force=True):
        return self._root.bind_new_context(self.toName(name))

    bindNewContextByString = bindNewContext

    def list(self, context=None, how_many=1000, bindings=None, iterator=None):
        found, further = (context or self._root).list(how_many)
        while further is not None:
            more, part = further.next_n(how_many)
            found += part
            if not more:
                further.destroy()
                break
        if bindings is not None:
            bindings[:] = [found]
        return found

    listBinding = list

    def listByKind(self, context_name, kind):
        context = self._root if not context_name else self.resolve(context_name)._narrow(CosNaming.NamingContext)
        return [one for one in self.list(context) if one.binding_name[-1].kind == kind]

    def clearAll(self):
        for one in self.list():
            self._root.unbind(one.binding_name)

    destroyRecursive = clearAll
