#include "SpeakerSVC_impl.h"
#include <rtm/CORBA_SeqUtil.h>
#include <iostream>

template <class T>
struct seq_print
{
  seq_print() : m_cnt(0) {}
  void operator()(T val)
  {
    std::cout << m_cnt << ": " << val << std::endl;
    ++m_cnt;
  }
  int m_cnt;
};

SpeakerSVC_impl::SpeakerSVC_impl()
 : m_level(0)
{
}

SpeakerSVC_impl::~SpeakerSVC_impl()
{
}

char* SpeakerSVC_impl::say(const char* text)
{
  CORBA_SeqUtil::push_back(m_history, text);
  std::cout << "said: " << text << std::endl;
  return CORBA::string_dup(text);
}

SpeakerDemo::Words* SpeakerSVC_impl::get_history()
{
  CORBA_SeqUtil::for_each(m_history, seq_print<const char*>());
  SpeakerDemo::Words_var words;
  words = new SpeakerDemo::Words(m_history);
  return words._retn();
}

void SpeakerSVC_impl::set_level(CORBA::Float level)
{
  CORBA_SeqUtil::push_back(m_levels, level);
  m_level = level;
  return;
}

CORBA::Float SpeakerSVC_impl::get_level()
{
  return m_level;
}

SpeakerDemo::Levels* SpeakerSVC_impl::get_levels()
{
  SpeakerDemo::Levels_var levels;
  levels = new SpeakerDemo::Levels(m_levels);
  return levels._retn();
}

CORBA::Boolean SpeakerSVC_impl::utter(const SpeakerDemo::Sentence& sentence, CORBA::Long& count, CORBA::Double& effort)
{
  if (m_level < 0) throw SpeakerDemo::Muted("level is negative");
  count = static_cast<CORBA::Long>(sentence.text.length());
  effort += count;
  return true;
}
