// Every interface of the wire contract has the repository ID of the contract.
#include <gtest/gtest.h>

#include "idl/all_stubs.h"

namespace {

struct Interface {
  const char* stub_id;
  CORBA::TypeCode_ptr type;
  const char* id;
};

const Interface interfaces[] = {
    {SDOPackage::SDOSystemElement::_PD_repoId, SDOPackage::_tc_SDOSystemElement, "IDL:org.omg/SDOPackage/SDOSystemElement:1.0"},
    {SDOPackage::SDO::_PD_repoId, SDOPackage::_tc_SDO, "IDL:org.omg/SDOPackage/SDO:1.0"},
    {SDOPackage::Configuration::_PD_repoId, SDOPackage::_tc_Configuration, "IDL:org.omg/SDOPackage/Configuration:1.0"},
    {SDOPackage::Monitoring::_PD_repoId, SDOPackage::_tc_Monitoring, "IDL:org.omg/SDOPackage/Monitoring:1.0"},
    {SDOPackage::SDOService::_PD_repoId, SDOPackage::_tc_SDOService, "IDL:org.omg/SDOPackage/SDOService:1.0"},
    {SDOPackage::Organization::_PD_repoId, SDOPackage::_tc_Organization, "IDL:org.omg/SDOPackage/Organization:1.0"},
    {RTC::ComponentAction::_PD_repoId, RTC::_tc_ComponentAction, "IDL:omg.org/RTC/ComponentAction:1.0"},
    {RTC::LightweightRTObject::_PD_repoId, RTC::_tc_LightweightRTObject, "IDL:omg.org/RTC/LightweightRTObject:1.0"},
    {RTC::ExecutionContext::_PD_repoId, RTC::_tc_ExecutionContext, "IDL:omg.org/RTC/ExecutionContext:1.0"},
    {RTC::DataFlowComponentAction::_PD_repoId, RTC::_tc_DataFlowComponentAction, "IDL:omg.org/RTC/DataFlowComponentAction:1.0"},
    {RTC::DataFlowComponent::_PD_repoId, RTC::_tc_DataFlowComponent, "IDL:omg.org/RTC/DataFlowComponent:1.0"},
    {RTC::Fsm::_PD_repoId, RTC::_tc_Fsm, "IDL:omg.org/RTC/Fsm:1.0"},
    {RTC::FsmParticipantAction::_PD_repoId, RTC::_tc_FsmParticipantAction, "IDL:omg.org/RTC/FsmParticipantAction:1.0"},
    {RTC::FsmParticipant::_PD_repoId, RTC::_tc_FsmParticipant, "IDL:omg.org/RTC/FsmParticipant:1.0"},
    {RTC::Mode::_PD_repoId, RTC::_tc_Mode, "IDL:omg.org/RTC/Mode:1.0"},
    {RTC::ModeCapable::_PD_repoId, RTC::_tc_ModeCapable, "IDL:omg.org/RTC/ModeCapable:1.0"},
    {RTC::MultiModeComponentAction::_PD_repoId, RTC::_tc_MultiModeComponentAction, "IDL:omg.org/RTC/MultiModeComponentAction:1.0"},
    {RTC::MultiModeObject::_PD_repoId, RTC::_tc_MultiModeObject, "IDL:omg.org/RTC/MultiModeObject:1.0"},
    {RTC::FsmObject::_PD_repoId, RTC::_tc_FsmObject, "IDL:omg.org/RTC/FsmObject:1.0"},
    {RTC::FsmService::_PD_repoId, RTC::_tc_FsmService, "IDL:omg.org/RTC/FsmService:1.0"},
    {RTC::PortService::_PD_repoId, RTC::_tc_PortService, "IDL:omg.org/RTC/PortService:1.0"},
    {RTC::ExecutionContextService::_PD_repoId, RTC::_tc_ExecutionContextService, "IDL:omg.org/RTC/ExecutionContextService:1.0"},
    {RTC::RTObject::_PD_repoId, RTC::_tc_RTObject, "IDL:omg.org/RTC/RTObject:1.0"},
    {OpenRTM::DataFlowComponent::_PD_repoId, OpenRTM::_tc_DataFlowComponent, "IDL:openrtm.aist.go.jp/OpenRTM/DataFlowComponent:1.0"},
    {OpenRTM::ExtTrigExecutionContextService::_PD_repoId, OpenRTM::_tc_ExtTrigExecutionContextService,
     "IDL:openrtm.aist.go.jp/OpenRTM/ExtTrigExecutionContextService:1.0"},
    {OpenRTM::InPortCdr::_PD_repoId, OpenRTM::_tc_InPortCdr, "IDL:OpenRTM/InPortCdr:1.0"},
    {OpenRTM::OutPortCdr::_PD_repoId, OpenRTM::_tc_OutPortCdr, "IDL:OpenRTM/OutPortCdr:1.0"},
    {RTC::DataPushService::_PD_repoId, RTC::_tc_DataPushService, "IDL:omg.org/RTC/DataPushService:1.0"},
    {RTC::DataPullService::_PD_repoId, RTC::_tc_DataPullService, "IDL:omg.org/RTC/DataPullService:1.0"},
    {OpenRTM::InPortCdrUDP::_PD_repoId, OpenRTM::_tc_InPortCdrUDP, "IDL:openrtm.aist.go.jp/OpenRTM/InPortCdrUDP:1.0"},
    {OpenRTM::PortSharedMemory::_PD_repoId, OpenRTM::_tc_PortSharedMemory, "IDL:OpenRTM/PortSharedMemory:1.0"},
    {RTM::Manager::_PD_repoId, RTM::_tc_Manager, "IDL:RTM/Manager:1.0"},
    {RTC::ExtendedFsmService::_PD_repoId, RTC::_tc_ExtendedFsmService, "IDL:omg.org/RTC/ExtendedFsmService:1.0"},
    {OpenRTM::ComponentObserver::_PD_repoId, OpenRTM::_tc_ComponentObserver, "IDL:OpenRTM/ComponentObserver:1.0"},
    {RTC::ComponentObserver::_PD_repoId, RTC::_tc_ComponentObserver, "IDL:omg.org/RTC/ComponentObserver:1.0"},
    {OpenRTM::Logger::_PD_repoId, OpenRTM::_tc_Logger, "IDL:OpenRTM/Logger:1.0"},
    {OpenRTM::LogicalTimeTriggeredEC::_PD_repoId, OpenRTM::_tc_LogicalTimeTriggeredEC,
     "IDL:openrtm.org/OpenRTM/LogicalTimeTriggeredEC:1.0"},
    {Img::CameraCaptureService::_PD_repoId, Img::_tc_CameraCaptureService, "IDL:Img/CameraCaptureService:1.0"},
    // The service interfaces of the RT Component interface guidelines.
    {RTC::ActArray::_PD_repoId, RTC::_tc_ActArray, "IDL:RTC/ActArray:1.0"},
    {RTC::AIO::_PD_repoId, RTC::_tc_AIO, "IDL:RTC/AIO:1.0"},
    {RTC::Bumper::_PD_repoId, RTC::_tc_Bumper, "IDL:RTC/Bumper:1.0"},
    {RTC::Camera::_PD_repoId, RTC::_tc_Camera, "IDL:RTC/Camera:1.0"},
    {RTC::CarlikeControl::_PD_repoId, RTC::_tc_CarlikeControl, "IDL:RTC/CarlikeControl:1.0"},
    {RTC::DIO::_PD_repoId, RTC::_tc_DIO, "IDL:RTC/DIO:1.0"},
    {RTC::Fiducial::_PD_repoId, RTC::_tc_Fiducial, "IDL:RTC/Fiducial:1.0"},
    {RTC::GPS::_PD_repoId, RTC::_tc_GPS, "IDL:RTC/GPS:1.0"},
    {RTC::Gripper::_PD_repoId, RTC::_tc_Gripper, "IDL:RTC/Gripper:1.0"},
    {RTC::HeadingControl2D::_PD_repoId, RTC::_tc_HeadingControl2D, "IDL:RTC/HeadingControl2D:1.0"},
    {RTC::HeadingControl3D::_PD_repoId, RTC::_tc_HeadingControl3D, "IDL:RTC/HeadingControl3D:1.0"},
    {RTC::IMU::_PD_repoId, RTC::_tc_IMU, "IDL:RTC/IMU:1.0"},
    {RTC::INS::_PD_repoId, RTC::_tc_INS, "IDL:RTC/INS:1.0"},
    {RTC::Multicamera::_PD_repoId, RTC::_tc_Multicamera, "IDL:RTC/Multicamera:1.0"},
    {RTC::Odometry2D::_PD_repoId, RTC::_tc_Odometry2D, "IDL:RTC/Odometry2D:1.0"},
    {RTC::Odometry3D::_PD_repoId, RTC::_tc_Odometry3D, "IDL:RTC/Odometry3D:1.0"},
    {RTC::OGMap::_PD_repoId, RTC::_tc_OGMap, "IDL:RTC/OGMap:1.0"},
    {RTC::PanTilt::_PD_repoId, RTC::_tc_PanTilt, "IDL:RTC/PanTilt:1.0"},
    {RTC::PathFollower2D::_PD_repoId, RTC::_tc_PathFollower2D, "IDL:RTC/PathFollower2D:1.0"},
    {RTC::PathFollower3D::_PD_repoId, RTC::_tc_PathFollower3D, "IDL:RTC/PathFollower3D:1.0"},
    {RTC::PathPlanner2D::_PD_repoId, RTC::_tc_PathPlanner2D, "IDL:RTC/PathPlanner2D:1.0"},
    {RTC::PathPlanner3D::_PD_repoId, RTC::_tc_PathPlanner3D, "IDL:RTC/PathPlanner3D:1.0"},
    {RTC::PointCloudServices::_PD_repoId, RTC::_tc_PointCloudServices, "IDL:RTC/PointCloudServices:1.0"},
    {RTC::PoseControl2D::_PD_repoId, RTC::_tc_PoseControl2D, "IDL:RTC/PoseControl2D:1.0"},
    {RTC::PoseControl3D::_PD_repoId, RTC::_tc_PoseControl3D, "IDL:RTC/PoseControl3D:1.0"},
    {RTC::Ranger::_PD_repoId, RTC::_tc_Ranger, "IDL:RTC/Ranger:1.0"},
    {RTC::RFID::_PD_repoId, RTC::_tc_RFID, "IDL:RTC/RFID:1.0"},
    {RTC::VelocityControl2D::_PD_repoId, RTC::_tc_VelocityControl2D, "IDL:RTC/VelocityControl2D:1.0"},
    {RTC::VelocityControl3D::_PD_repoId, RTC::_tc_VelocityControl3D, "IDL:RTC/VelocityControl3D:1.0"},
    {JARA_ARM::ManipulatorCommonInterface_Common::_PD_repoId, JARA_ARM::_tc_ManipulatorCommonInterface_Common,
     "IDL:JARA_ARM/ManipulatorCommonInterface_Common:1.0"},
    {JARA_ARM::ManipulatorCommonInterface_Middle::_PD_repoId, JARA_ARM::_tc_ManipulatorCommonInterface_Middle,
     "IDL:JARA_ARM/ManipulatorCommonInterface_Middle:1.0"},
    {RTC::Limb::_PD_repoId, RTC::_tc_Limb, "IDL:RTC/Limb:1.0"},
    {OpenHRP::RobotHardwareService::_PD_repoId, OpenHRP::_tc_RobotHardwareService, "IDL:OpenHRP/RobotHardwareService:1.0"},
};

TEST(WireTypes, every_interface_has_the_id_of_the_contract) {
  for (const Interface& interface : interfaces) {
    EXPECT_STREQ(interface.stub_id, interface.id);
    EXPECT_STREQ(interface.type->id(), interface.id);
  }
}

}  // namespace
