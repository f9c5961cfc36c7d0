"""Serializers between shorts and doubles, in both directions, and one that is no CDR; for manager.modules.preload."""
import OpenRTM_aist
import RTC


class FromShort(OpenRTM_aist.CORBA_CdrMemoryStream):
    def __init__(self):
        OpenRTM_aist.CORBA_CdrMemoryStream.__init__(self)

    def deserialize(self, cdr, data_type):
        code, value = OpenRTM_aist.CORBA_CdrMemoryStream.deserialize(self, cdr, RTC.TimedShort)
        if code != OpenRTM_aist.ByteDataStreamBase.SERIALIZE_OK:
            return code, data_type
        return code, RTC.TimedDouble(value.tm, float(value.data))


class ToDouble(OpenRTM_aist.CORBA_CdrMemoryStream):
    def serialize(self, data):
        return OpenRTM_aist.CORBA_CdrMemoryStream.serialize(self, RTC.TimedDouble(data.tm, float(data.data)))


class Text(OpenRTM_aist.ByteDataStreamBase):
    def init(self, prop):
        self._end = prop.getProperty("text.end") or "."

    def serialize(self, data):
        if data.data == 13:
            raise ValueError("not this one")
        return OpenRTM_aist.ByteDataStreamBase.SERIALIZE_OK, ("%d%s" % (data.data, self._end)).encode()

    def deserialize(self, cdr, data_type):
        if not cdr.endswith(self._end.encode()):
            return OpenRTM_aist.ByteDataStreamBase.SERIALIZE_ERROR, None
        return OpenRTM_aist.ByteDataStreamBase.SERIALIZE_OK, data_type(RTC.Time(1, 0), float(cdr[:-1]))


def ShortToDoubleInit(manager):
    factories = OpenRTM_aist.SerializerFactories.instance()
    factories.addSerializer("cdr:RTC/TimedShort:RTC/TimedDouble", FromShort, RTC.TimedDouble)
    factories.addSerializer("cdr:RTC/TimedDouble:RTC/TimedShort", ToDouble, RTC.TimedShort(RTC.Time(0, 0), 0))
    factories.addSerializerGlobal("text", Text)
