"""The SDO service RTC.ExtendedFsmService, which shows the state machine of a component to tools."""
import RTC
import RTC__POA

from .listeners import FsmProfileListenerType, FsmStructureListenerType
from .sdo import SdoServiceProviderBase


class FsmService(SdoServiceProviderBase, RTC__POA.ExtendedFsmService):
    def __init__(self, machine, structure):
        self._machine = machine
        self._structure = structure

    def get_current_state(self):
        machine = self._machine
        state = machine.current() if machine is not None else None
        return state.__name__ if state is not None else ""

    def set_fsm_structure(self, fsm_structure):
        """What tools see; the machine itself is code and stays as it is."""
        if fsm_structure.name != self._structure.name:
            return RTC.BAD_PARAMETER
        self._structure = fsm_structure
        self._tell(FsmStructureListenerType.SET_FSM_STRUCTURE)
        return RTC.RTC_OK

    def get_fsm_structure(self):
        self._tell(FsmStructureListenerType.GET_FSM_STRUCTURE)
        return RTC.RTC_OK, self._structure

    def add_event(self, name, data_type):
        profile = RTC.FsmEventProfile(name, data_type)
        self._structure.event_profiles.append(profile)
        if self._machine is not None:
            component = self._machine.component
            component._rtm_tell_listeners("profile", FsmProfileListenerType.BIND_FSM_EVENT, profile)
            component._rtm_notify_fsm(False, name)

    def finalize(self):
        self._machine = None

    def _tell(self, type_):
        if self._machine is not None:
            component = self._machine.component
            component._rtm_tell_listeners("structure", type_, self._structure)
            if type_ == FsmStructureListenerType.SET_FSM_STRUCTURE:
                component._rtm_notify_fsm(True, self._structure.name)


def offer(machine, top):
    """Offers the service at the machine's component. A component with a second machine shows the first one."""
    import SDOPackage
    id_ = RTC.ExtendedFsmService._NP_RepositoryId
    service = FsmService(machine, RTC.FsmStructure(top.__name__, "", [], []))
    profile = SDOPackage.ServiceProfile(id_, id_, [], service._this())
    machine._service = service if machine.component.addSdoServiceProvider(profile, service) else None
