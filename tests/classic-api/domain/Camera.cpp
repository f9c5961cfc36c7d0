// A camera and image component as the community writes them: both camera types, memcpy into sequences, the capture service.
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>
#include <rtm/ext/CameraCommonInterfaceSkel.h>
#include "CameraCommonInterfaceStub.h"

#include <cstring>
#include <vector>

using namespace Img;

class CaptureSVC_impl : public virtual POA_Img::CameraCaptureService, public virtual PortableServer::RefCountServantBase
{
public:
  CaptureSVC_impl() : m_frames(0) {}
  void take_one_frame() { m_frames = 1; }
  void take_multi_frames(CORBA::Long num) { m_frames = num; }
  void start_continuous() { m_frames = -1; }
  void stop_continuous() { m_frames = 0; }
  void getProfile(Img::CameraDeviceProfile_out profile)
  {
    profile = new Img::CameraDeviceProfile();
    profile->vendor_name = "Somebody";
    profile->intrinsic.distortion_coefficient.length(5);
    profile->properties.length(1);
    profile->properties[0].name = "resolution";
    profile->properties[0].value = "320x240";
  }
  int m_frames;
};

class Camera : public RTC::DataFlowComponentBase
{
public:
  Camera(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      m_originalOut("original_image", m_original),
      m_simpleOut("image", m_simple),
      m_imageIn("in", m_in),
      m_CapturePort("Capture")
  {
  }

  virtual RTC::ReturnCode_t onInitialize()
  {
    addInPort("in", m_imageIn);
    addOutPort("original_image", m_originalOut);
    addOutPort("image", m_simpleOut);
    m_CapturePort.registerProvider("CameraCaptureService", "Img::CameraCaptureService", m_capture);
    addPort(m_CapturePort);
    bindParameter("camera_id", m_camera_id, "0");
    bindParameter("image_size", m_size, "320,240");
    return RTC::RTC_OK;
  }

  virtual RTC::ReturnCode_t onActivated(RTC::UniqueId)
  {
    m_buffer.assign(320 * 240 * 3, 128);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) m_original.data.extrinsic[i][j] = i == j ? 1.0 : 0.0;
    for (int i = 0; i < 5; ++i) m_original.data.intrinsic.matrix_element[i] = 0.0;
    m_original.data.intrinsic.distortion_coefficient.length(5);
    return RTC::RTC_OK;
  }

  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId)
  {
    int len = static_cast<int>(m_buffer.size());
    m_simple.width = 320;
    m_simple.height = 240;
    m_simple.bpp = 24;
    m_simple.format = "bitmap";
    m_simple.fDiv = 1.0 / 255.0;
    m_simple.pixels.length(len);
    memcpy((void *)&(m_simple.pixels[0]), &m_buffer[0], len);
    setTimestamp(m_simple);
    m_simpleOut.write();

    m_original.data.image.width = 320;
    m_original.data.image.height = 240;
    m_original.data.image.format = Img::CF_RGB;
    m_original.data.image.raw_data.length(len);
    memcpy(m_original.data.image.raw_data.get_buffer(), &m_buffer[0], len);
    m_original.error_code = 0;
    m_original.tm.sec = m_original.data.captured_time.sec = 1;
    m_originalOut << m_original;

    if (m_imageIn.isNew())
      {
        do { m_imageIn.read(); } while (m_imageIn.isNew());
        const unsigned char* pixels = m_in.pixels.get_buffer();
        m_buffer.assign(pixels, pixels + m_in.pixels.length());
        std::string format(m_in.format);
        coil::eraseBlank(format);
      }
    return RTC::RTC_OK;
  }

protected:
  Img::TimedCameraImage m_original;
  RTC::OutPort<Img::TimedCameraImage> m_originalOut;
  RTC::CameraImage m_simple;
  RTC::OutPort<RTC::CameraImage> m_simpleOut;
  RTC::CameraImage m_in;
  RTC::InPort<RTC::CameraImage> m_imageIn;
  RTC::CorbaPort m_CapturePort;
  CaptureSVC_impl m_capture;
  short int m_camera_id;
  std::string m_size;
  std::vector<unsigned char> m_buffer;
};

static const char* const camera_spec[] =
  {
    "implementation_id", "Camera",
    "type_name",         "Camera",
    "description",       "Camera component",
    "version",           "1.0",
    "vendor",            "Somebody",
    "category",          "ImageProcessing",
    "activity_type",     "PERIODIC",
    "max_instance",      "3",
    "language",          "C++",
    "lang_type",         "compile",
    ""
  };

extern "C"
{
  DLL_EXPORT void CameraInit(RTC::Manager* manager)
  {
    coil::Properties profile(camera_spec);
    manager->registerFactory(profile, RTC::Create<Camera>, RTC::Delete<Camera>);
  }
}
