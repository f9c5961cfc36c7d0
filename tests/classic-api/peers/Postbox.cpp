// -*- C++ -*-
// A module that takes the log away: logger.plugins names it, logger.logstream.postbox.file says where the lines go.
#include <rtm/Manager.h>
#include <rtm/LogstreamBase.h>
#include <rtm/SystemLogger.h>
#include <coil/Factory.h>
#include <coil/Logger.h>

#include <fstream>
#include <string>

class PostboxStream : public ::coil::LogStreamBuffer
{
public:
  bool open(const std::string& file)
  {
    m_file.open(file.c_str());
    return m_file.good();
  }
  void write(int level, const std::string& name, const std::string& date, const std::string& mes) override
  {
    m_file << RTC::Logger::getLevelString(level) << "|" << name << "|" << mes << std::endl;
  }

private:
  std::ofstream m_file;
};

class Postbox : public RTC::LogstreamBase
{
public:
  Postbox() {}
  ~Postbox() override {}
  bool init(const coil::Properties& prop) override
  {
    return m_stream.open(prop.getProperty("file"));
  }
  ::coil::LogStreamBuffer* getStreamBuffer() override { return &m_stream; }
  bool shutdown() override { return true; }

private:
  PostboxStream m_stream;
};

extern "C"
{
  DLL_EXPORT void PostboxInit(RTC::Manager* /*manager*/)
  {
    RTC::LogstreamFactory::instance().addFactory("postbox",
                                                 ::coil::Creator< ::RTC::LogstreamBase, Postbox>,
                                                 ::coil::Destructor< ::RTC::LogstreamBase, Postbox>);
  }
}
