// The servant, as the 1.x generator lays it out.
#include "SpeakerSkel.h"

#ifndef SPEAKERSVC_IMPL_H
#define SPEAKERSVC_IMPL_H

#include <string>
#include <vector>

/*!
 * Example class implementing IDL interface SpeakerDemo::Speaker
 */
class SpeakerSVC_impl
 : public virtual POA_SpeakerDemo::Speaker,
   public virtual PortableServer::RefCountServantBase
{
 private:
   // Make sure all instances are built on the heap by making the
   // destructor non-public
   //virtual ~SpeakerSVC_impl();

 public:
   // standard constructor
   SpeakerSVC_impl();
   virtual ~SpeakerSVC_impl();

   // attributes and operations
   char* say(const char* text);
   SpeakerDemo::Words* get_history();
   void set_level(CORBA::Float level);
   CORBA::Float get_level();
   SpeakerDemo::Levels* get_levels();
   CORBA::Boolean utter(const SpeakerDemo::Sentence& sentence, CORBA::Long& count, CORBA::Double& effort);

private:
  CORBA::Float m_level;
  SpeakerDemo::Words m_history;
  SpeakerDemo::Levels m_levels;
};

#endif // SPEAKERSVC_IMPL_H
