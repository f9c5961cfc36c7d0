"""SDO services: what a component offers to tools beside its ports, and what tools attach to it.

A provider is a servant of the service's IDL interface and a SdoServiceProviderBase; a consumer is a SdoServiceConsumerBase, made for each
service of its interface that a tool attaches (SDOPackage.Configuration.add_service_profile). Both are registered by the repository id of
that interface.
"""
import SDOPackage__POA
import _openrtm_core as _core

from .utility import _Factory

__all__ = ["SdoServiceProviderBase", "SdoServiceConsumerBase", "SdoServiceProviderFactory", "SdoServiceConsumerFactory"]


class _Service:
    def init(self, rtobj, profile):
        """Takes the component and the service's profile. False: the service cannot be used."""
        self._profile = profile
        return True

    def reinit(self, profile):
        """The same service with other properties."""
        self._profile = profile
        return True

    def getProfile(self):
        return self._profile

    def finalize(self):
        """Nothing is called afterwards."""


class SdoServiceConsumerBase(_Service):
    pass


class SdoServiceProviderBase(_Service, SDOPackage__POA.SDOService):
    pass


class SdoServiceConsumerFactory(_Factory):
    _add, _remove = staticmethod(_core.sdo_consumer_add_factory), staticmethod(_core.sdo_consumer_remove_factory)
    _identifiers = staticmethod(_core.sdo_consumer_identifiers)


class SdoServiceProviderFactory(_Factory):
    _add, _remove = staticmethod(_core.sdo_provider_add_factory), staticmethod(_core.sdo_provider_remove_factory)
    _identifiers = staticmethod(_core.sdo_provider_identifiers)
