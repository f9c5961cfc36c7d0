#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys, subprocess, asyncio, threading, http.server, urllib.request, concurrent.futures, multiprocessing, logging
import RTC, OpenRTM_aist

servers_spec = ["implementation_id", "Servers", "type_name", "Servers", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Servers(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self.got = []
    def onInitialize(self):
        self.out = subprocess.check_output(["echo", "hi"])
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        class H(http.server.BaseHTTPRequestHandler):
            comp = self
            def do_GET(self):
                self.send_response(200); self.end_headers(); self.wfile.write(b"x")
            def log_message(self, *a): pass
        self.srv = http.server.HTTPServer(("127.0.0.1", 0), H)
        threading.Thread(target=self.srv.serve_forever, daemon=True).start()
        self.ex = concurrent.futures.ThreadPoolExecutor(2)
        return RTC.RTC_OK
    async def work(self):
        await asyncio.sleep(0.001)
        self.got.append(1)
    def onExecute(self, ec_id):
        asyncio.run_coroutine_threadsafe(self.work(), self.loop)
        if self.got and not hasattr(self, "said"):
            x = urllib.request.urlopen("http://127.0.0.1:%d" % self.srv.server_port).read()
            y = self.ex.submit(lambda: 5).result()
            p = multiprocessing.get_context("spawn")
            self.said = print("OK Servers", self.out, x, y)
            logging.getLogger("x").warning("warn")
        return RTC.RTC_OK

def ServersInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=servers_spec), Servers, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    ServersInit(manager)
    manager.createComponent("Servers")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
