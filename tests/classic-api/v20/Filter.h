// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  Filter.h
 * @brief A component in the manner of the 2.x generator
 */
// </rtc-template>

#ifndef FILTER_H
#define FILTER_H

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

// Service implementation headers
// <rtc-template block="service_impl_h">

// </rtc-template>

// Service Consumer stub headers
// <rtc-template block="consumer_stub_h">

// </rtc-template>

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

// <rtc-template block="component_description">
/*!
 * @class Filter
 * @brief ModuleDescription
 */
// </rtc-template>
class Filter
  : public RTC::DataFlowComponentBase
{
 public:
  /*!
   * @brief constructor
   * @param manager Maneger Object
   */
  Filter(RTC::Manager* manager);

  /*!
   * @brief destructor
   */
  ~Filter() override;

  // <rtc-template block="public_attribute">

  // </rtc-template>

  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onFinalize() override;
  RTC::ReturnCode_t onStartup(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onShutdown(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onAborting(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onError(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onReset(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onStateUpdate(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onRateChanged(RTC::UniqueId ec_id) override;

 protected:
  // Configuration variable declaration
  // <rtc-template block="config_declare">
  /*!
   * - Name:  gain
   * - DefaultValue: 1.0
   */
  double m_gain;
  std::vector<double> m_coefficients;
  // </rtc-template>

  // DataInPort declaration
  // <rtc-template block="inport_declare">
  RTC::TimedVelocity2D m_in;
  /*!
   */
  RTC::InPort<RTC::TimedVelocity2D> m_inIn;
  RTC::RangeData m_range;
  RTC::InPort<RTC::RangeData> m_rangeIn;
  // </rtc-template>

  // DataOutPort declaration
  // <rtc-template block="outport_declare">
  RTC::TimedVelocity2D m_out;
  /*!
   */
  RTC::OutPort<RTC::TimedVelocity2D> m_outOut;
  // </rtc-template>

 private:
  // <rtc-template block="private_attribute">

  // </rtc-template>
};


extern "C"
{
  DLL_EXPORT void FilterInit(RTC::Manager* manager);
};

#endif // FILTER_H
