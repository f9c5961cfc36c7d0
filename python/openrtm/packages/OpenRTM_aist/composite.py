"""Components that consist of other components."""
import re

from .component import DataFlowComponentBase
from .listeners import ConfigurationSetListenerType, ConfigurationSetNameListenerType
from .logger import Logger

__all__ = ["PeriodicECSharedComposite"]


class PeriodicECSharedComposite(DataFlowComponentBase):
    """Its members run in its execution context and follow its state. The configuration has `members` (instance names, separated by | or
    commas) and `exported_ports` (MEMBER.PORT, separated by commas): these ports of members become ports of the composite."""

    def __init__(self, manager):
        DataFlowComponentBase.__init__(self, manager)
        self._rtm_organize()
        self._members = [[""]]
        self.bindParameter("members", self._members, "")

    def onInitialize(self):
        self.addConfigurationSetNameListener(ConfigurationSetNameListenerType.ON_ACTIVATE_CONFIG_SET, self._rtm_activated)
        self.addConfigurationSetListener(ConfigurationSetListenerType.ON_SET_CONFIG_SET, self._rtm_changed)
        configuration = self.getConfigService()
        configuration.update("default")
        log = Logger(self.getInstanceName())
        members = []
        for name in filter(None, (one.strip() for one in re.split("[|,]", ",".join(self._members[0])))):
            found = self._manager.getNaming().string_to_component(name)
            if found:
                members.append(found[0])
            else:
                log.RTC_ERROR('no component "%s" that could be a member', name)
        ports = configuration.getConfigurationSet("default").getProperty("exported_ports")
        self._rtm_export_ports(ports or self.getProperties().getProperty("exported_ports"))
        problem = self._rtm_add_members(members)
        if problem:
            log.RTC_ERROR("a component does not become a member: %s", problem)
        return DataFlowComponentBase.onInitialize(self)

    def onActivated(self, ec_id):
        self._rtm_members("activate")
        return DataFlowComponentBase.onActivated(self, ec_id)

    def onDeactivated(self, ec_id):
        self._rtm_members("deactivate")
        return DataFlowComponentBase.onDeactivated(self, ec_id)

    def onReset(self, ec_id):
        self._rtm_members("reset")
        return DataFlowComponentBase.onReset(self, ec_id)

    def onFinalize(self):
        self._rtm_members("close")
        return DataFlowComponentBase.onFinalize(self)

    # Tools look for the ports right after they have changed the parameter or the set.
    def _rtm_activated(self, name):
        self._rtm_follow(self.getConfigService().getConfigurationSet(name))

    def _rtm_changed(self, config_set):
        if config_set.getName() == self.getConfigService().getActiveId():
            self._rtm_follow(config_set)

    def _rtm_follow(self, config_set):
        if config_set.hasKey("exported_ports") is not None:
            self._rtm_export_ports(config_set.getProperty("exported_ports"))
