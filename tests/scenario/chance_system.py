# Systems of Chance components, and of others, as RTSProfiles.
HEAD = ('<?xml version="1.0" encoding="UTF-8"?><rts:RtsProfile xmlns:rts="http://www.openrtp.org/namespaces/rts" '
        'xmlns:rtsExt="http://www.openrtp.org/namespaces/rts_ext" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
        'rts:id="RTSystem:rtm-sim:Chance:1" rts:version="0.2">')
CHANCE = "RTC:rtm-sim:test:Chance:1.0.0"


def component(name, rate=100, id=CHANCE, **values):
    data = "".join(f'<rts:ConfigurationData rts:name="{key}" rts:data="{value}"/>' for key, value in values.items())
    return (f'<rts:Components xsi:type="rtsExt:component_ext" rts:id="{id}" rts:pathUri="localhost/{name}.rtc" rts:instanceName="{name}" '
            f'rts:activeConfigurationSet="default" rts:compositeType="None" rts:isRequired="true"><rts:ConfigurationSets rts:id="default">{data}</rts:ConfigurationSets>'
            f'<rts:ExecutionContexts xsi:type="rtsExt:execution_context_ext" rts:id="0" rts:kind="PERIODIC" rts:rate="{rate}"/></rts:Components>')


# A link "A.out -> B.in" with properties as in a connector profile.
def link(source, target, type="IDL:RTC/TimedLong:1.0", dataflow="push", subscription="flush", interface="corba_cdr", source_id=CHANCE, target_id=CHANCE, **more):
    end = lambda tag, port, id: (f'<rts:{tag} xsi:type="rtsExt:target_port_ext" rts:componentId="{id}" rts:instanceName="{port.split(".")[0]}" rts:portName="{port}">'
                                 f'<rtsExt:Properties rtsExt:name="COMPONENT_PATH_ID" rtsExt:value="localhost/{port.split(".")[0]}.rtc"/></rts:{tag}>')
    values = {"dataport.dataflow_type": dataflow, "dataport.interface_type": interface, "dataport.subscription_type": subscription, "dataport.data_type": type,
              **{"dataport." + key.replace("__", "."): value for key, value in more.items()}}
    properties = "".join(f'<rtsExt:Properties rtsExt:name="{key}" rtsExt:value="{value}"/>' for key, value in values.items())
    return (f'<rts:DataPortConnectors xsi:type="rtsExt:dataport_connector_ext" rts:connectorId="{source}-{target}" rts:name="{source}_{target}" rts:dataType="{type}" '
            f'rts:interfaceType="{interface}" rts:dataflowType="{dataflow}" rts:subscriptionType="{subscription}">'
            f'{end("sourceDataPort", source, source_id)}{end("targetDataPort", target, target_id)}{properties}</rts:DataPortConnectors>')


# A service between two ports "A.port".
def service(one, other, id=CHANCE, other_id=CHANCE):
    end = lambda tag, port, id: (f'<rts:{tag} xsi:type="rtsExt:target_port_ext" rts:componentId="{id}" rts:instanceName="{port.split(".")[0]}" rts:portName="{port}">'
                                 f'<rtsExt:Properties rtsExt:name="COMPONENT_PATH_ID" rtsExt:value="localhost/{port.split(".")[0]}.rtc"/></rts:{tag}>')
    return (f'<rts:ServicePortConnectors xsi:type="rtsExt:serviceport_connector_ext" rts:connectorId="{one}-{other}" rts:name="{one}_{other}">'
            f'{end("sourceServicePort", one, id)}{end("targetServicePort", other, other_id)}</rts:ServicePortConnectors>')


def system(*parts):
    return HEAD + "".join(parts) + "</rts:RtsProfile>"


# Four of one phase, each connected with the next and with itself's neighbour by another subscription type: every link is of one phase.
def ring(interface="corba_cdr", **races):
    names = ["A", "B", "C", "D"]
    parts = [component(name, start=i + 1, race=races.get(name, "")) for i, name in enumerate(names)]
    kinds = [{"subscription": "flush"}, {"subscription": "new", "publisher__push_policy": "all"}, {"subscription": "periodic", "publisher__push_rate": "40"},
             {"dataflow": "pull"}]
    for i, kind in enumerate(kinds):
        for distance in (1, 2):
            parts.append(link(f"{names[i]}.out", f"{names[(i + distance) % 4]}.in", interface=interface, **kinds[(i + distance) % 4]))
    if races:
        parts.append(link("A.loose", "C.in", interface=interface))
    return system(*parts)
