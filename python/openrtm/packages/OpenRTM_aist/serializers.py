"""Serializers of authors, which convert the values of a connection to bytes and back. dataport.marshaling_type selects one."""
import threading

import _openrtm_core as _core
import omniORB
from omniORB import tcInternal as _tc

__all__ = ["ByteDataStreamBase", "CORBA_CdrMemoryStream", "SerializerFactories", "SerializerFactory"]


class ByteDataStreamBase:
    """Base of serializers. serialize and deserialize return (code, result); a code other than SERIALIZE_OK is a failure."""
    SERIALIZE_OK, SERIALIZE_ERROR, SERIALIZE_NOTFOUND, SERIALIZE_NOT_SUPPORT_ENDIAN = range(4)

    def init(self, prop):
        """The properties of the connection, without the prefix "dataport."."""

    def isLittleEndian(self, little_endian):
        pass

    def serialize(self, data):
        return ByteDataStreamBase.SERIALIZE_NOTFOUND, b""

    def deserialize(self, cdr, data_type):
        return ByteDataStreamBase.SERIALIZE_NOTFOUND, data_type


class CORBA_CdrMemoryStream(ByteDataStreamBase):
    """Plain CDR, of any type: what derived classes build on."""

    def __init__(self):
        self._endian = None

    def isLittleEndian(self, little_endian):
        self._endian = little_endian

    def serialize(self, data):
        if self._endian is None:
            return ByteDataStreamBase.SERIALIZE_NOT_SUPPORT_ENDIAN, b""
        try:
            return ByteDataStreamBase.SERIALIZE_OK, omniORB.cdrMarshal(_tc.TypeCode(data._NP_RepositoryId), data, self._endian)
        except Exception:
            return ByteDataStreamBase.SERIALIZE_ERROR, b""

    def deserialize(self, cdr, data_type):
        """data_type: a value of the type, or its class."""
        if self._endian is None:
            return ByteDataStreamBase.SERIALIZE_NOT_SUPPORT_ENDIAN, data_type
        try:
            return ByteDataStreamBase.SERIALIZE_OK, omniORB.cdrUnmarshal(_tc.TypeCode(data_type._NP_RepositoryId), cdr, self._endian)
        except Exception:
            return ByteDataStreamBase.SERIALIZE_ERROR, data_type


class SerializerFactories:
    """The serializers of this process, by data type and name. Any thread."""
    _instance = None

    def __init__(self):
        self._classes = {}  # (repository id, or "" for all types): {name: class}
        self._lock = threading.Lock()

    @staticmethod
    def instance():
        if SerializerFactories._instance is None:
            SerializerFactories._instance = SerializerFactories()
        return SerializerFactories._instance

    def addSerializer(self, marshalingtype, serializer, datatype):
        """datatype: a value of the type, or its class. A name that is taken keeps its serializer."""
        self._add(datatype._NP_RepositoryId, marshalingtype, serializer)

    def addSerializerGlobal(self, marshalingtype, serializer):
        """For values of all types."""
        self._add("", marshalingtype, serializer)

    def removeSerializer(self, marshalingtype, datatype):
        self._remove(datatype._NP_RepositoryId, marshalingtype)

    def removeSerializerGlobal(self, marshalingtype):
        self._remove("", marshalingtype)

    def createSerializer(self, marshalingtype, datatype=None):
        """A new one, or None."""
        return self._create(marshalingtype, "" if datatype is None else datatype._NP_RepositoryId)

    def getSerializerList(self, datatype=None):
        return ["cdr"] + self._names_of("" if datatype is None else datatype._NP_RepositoryId)

    def _add(self, id_, name, cls):
        with self._lock:
            self._classes.setdefault(id_, {}).setdefault(name, cls)
            _core.set_serializer_names(id_, list(self._classes[id_]))

    def _remove(self, id_, name):
        with self._lock:
            self._classes.get(id_, {}).pop(name, None)
            _core.set_serializer_names(id_, list(self._classes.get(id_, {})))

    def _names_of(self, id_):
        with self._lock:
            names = set(self._classes.get("", {})) | set(self._classes.get(id_, {}))
        return sorted(names - {"cdr"})

    def _create(self, name, id_):
        with self._lock:
            cls = self._classes.get(id_, {}).get(name) or self._classes.get("", {}).get(name)
        if cls is None:
            return CORBA_CdrMemoryStream() if name == "cdr" else None
        return cls()


SerializerFactory = SerializerFactories
