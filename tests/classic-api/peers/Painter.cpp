// -*- C++ -*-
/*!
 * @file  Painter.cpp
 * @brief Parameters of every kind, in the manner of 1.2
 */
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/ConfigurationListener.h>

#include <chrono>
#include <iostream>
#include <string>
#include <vector>

enum Brush { BRUSH_THIN, BRUSH_BROAD };
enum class Mode { Dry, Wet };

inline std::istream& operator>>(std::istream& is, Brush& brush)
{
  std::string word;
  is >> word;
  if (word == "thin") { brush = BRUSH_THIN; }
  else if (word == "broad") { brush = BRUSH_BROAD; }
  else { is.setstate(std::ios::failbit); }
  return is;
}

bool toMode(Mode& mode, const char* str)
{
  std::string word(coil::normalize(std::string(str)));
  if (word != "dry" && word != "wet") { return false; }
  mode = word == "dry" ? Mode::Dry : Mode::Wet;
  return true;
}

struct Colour { int r, g, b; };

namespace coil
{
  template <>
  bool stringTo<Colour>(Colour& val, const char* str)
  {
    if (str == nullptr) { return false; }
    coil::vstring parts(coil::split(str, "/"));
    if (parts.size() != 3) { return false; }
    return coil::stringTo(val.r, parts[0].c_str()) && coil::stringTo(val.g, parts[1].c_str()) && coil::stringTo(val.b, parts[2].c_str());
  }
} // namespace coil

class Painter
  : public RTC::DataFlowComponentBase
{
 public:
  Painter(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      m_lineOut("line", m_line)
  {
  }

  RTC::ReturnCode_t onInitialize() override
  {
    addOutPort("line", m_lineOut);
    bindParameter("lengths", m_lengths, "1.5,2.5");
    bindParameter("names", m_names, "a,b");
    bindParameter("counts", m_counts, "1");
    bindParameter("brush", m_brush, "thin");
    bindParameter("mode", m_mode, "dry", toMode);
    bindParameter("colour", m_colour, "0/0/0");
    bindParameter("on", m_on, "YES");
    bindParameter("letter", m_letter, "x");
    bindParameter("big", m_big, "1");
    bindParameter("wait", m_wait, "0.25");
    bindParameter("title", m_title, "no title");
    addConfigurationSetNameListener(RTC::ON_ACTIVATE_CONFIG_SET, new SetListener(*this));
    addConfigurationParamListener(RTC::ConfigurationParamListenerType::ON_UPDATE_CONFIG_PARAM, new ParamListener(m_updates));
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override
  {
    std::string text;
    for (auto& length : m_lengths) { text += coil::otos(length) + " "; }
    text += coil::flatten(m_names) + " " + coil::otos(m_counts.size()) + (m_brush == BRUSH_BROAD ? " broad" : " thin");
    text += m_mode == Mode::Wet ? " wet " : " dry ";
    text += coil::otos(m_colour.r) + ":" + coil::otos(m_colour.g) + ":" + coil::otos(m_colour.b);
    text += std::string(m_on ? " on " : " off ") + m_letter + " " + coil::otos(m_big) + " " + coil::otos(m_wait.count()) + " " + m_title;
    if (text != m_last) { std::cout << text << std::endl; }
    m_last = text;
    return RTC::RTC_OK;
  }

 private:
  class SetListener : public RTC::ConfigurationSetNameListener
  {
   public:
    explicit SetListener(Painter& painter) : m_painter(painter) {}
    void operator()(const char* config_set_name) override { std::cout << "set " << config_set_name << std::endl; }
   private:
    Painter& m_painter;
  };
  class ParamListener : public RTC::ConfigurationParamListener
  {
   public:
    explicit ParamListener(int& count) : m_count(count) {}
    void operator()(const char*, const char*) override { ++m_count; }
   private:
    int& m_count;
  };

  RTC::TimedString m_line;
  RTC::OutPort<RTC::TimedString> m_lineOut;
  std::vector<double> m_lengths;
  std::vector<std::string> m_names;
  std::vector<int> m_counts;
  Brush m_brush{BRUSH_THIN};
  Mode m_mode{Mode::Dry};
  Colour m_colour{0, 0, 0};
  bool m_on{false};
  char m_letter{'?'};
  unsigned long long m_big{0};
  std::chrono::milliseconds m_wait{0};
  std::string m_title;
  std::string m_last;
  int m_updates{0};
};

static const char* painter_spec[] =
  {
    "implementation_id", "Painter",
    "type_name",         "Painter",
    "description",       "Parameters of every kind",
    "version",           "1.2.0",
    "vendor",            "peer",
    "category",          "demo",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    "exec_cxt.periodic.rate", "50",
    "conf.default.lengths", "1.5,2.5",
    "conf.default.names", "a,b",
    "conf.default.brush", "thin",
    "conf.wet.lengths", "3, 4.5 ,6",
    "conf.wet.names", "one, two",
    "conf.wet.counts", "7,8,9",
    "conf.wet.brush", "broad",
    "conf.wet.mode", "Wet",
    "conf.wet.colour", "1/2/3",
    "conf.wet.on", "NO",
    "conf.wet.letter", "q",
    "conf.wet.big", "18446744073709551615",
    "conf.wet.wait", "1.5",
    "conf.wet.title", "with blanks, and commas",
    "conf.__widget__.brush", "radio",
    "conf.__constraints__.brush", "(thin,broad)",
    "conf.__type__.lengths", "double[]",
    ""
  };

extern "C"
{
  DLL_EXPORT void PainterInit(RTC::Manager* manager)
  {
    coil::Properties profile(painter_spec);
    manager->registerFactory(profile, RTC::Create<Painter>, RTC::Delete<Painter>);
  }
};
