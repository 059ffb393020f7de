// What real Net F/T boxes answer to a GET of netftapi2.xml. Test data, not made from the driver.
#pragma once

#include <string_view>

namespace touchstone::hil {

// A Gamma, firmware 2.2.59: a public sample, shortened by whoever published it.
inline constexpr std::string_view netft_gamma_answer = R"(<?xml version="1.0"?><netft>
<runstat>0x00000000</runstat><runrate>7000</runrate>
<runpkmx>15186840;15450145;20557075;1367250;2491043;1854244</runpkmx>
<runmcb>0x00000000</runmcb><runmco>0x00</runmco><runmcl>0</runmcl>
<cfgnam>empty</cfgnam><cfgcalsel>0</cfgcalsel><cfgcalsn>FT27462</cfgcalsn>
<scfgfu>N</scfgfu><scfgtu>Nm</scfgtu>
<cfgtfx>0;0;132.710;0;0;0</cfgtfx><scfgtdu>mm</scfgtdu><scfgtau>degrees</scfgtau>
<cfgcpf>1000000</cfgcpf><cfgcpt>1000000</cfgcpt>
<cfgmr>330;330;990;30;30;30</cfgmr><setcfgsel>0</setcfgsel><setbias>745;17;447;184;-596;-253</setbias>
<setuserfilter>0</setuserfilter><nethwaddr>00:16:BD:00:23:56</nethwaddr><netip>192.168.1.11</netip>
<comrdte>Enabled</comrdte><comrdtrate>100</comrdtrate><comrdtbsiz>1</comrdtbsiz>
<mfgdigsn>LOT2821</mfgdigsn><mfgdigver>2.2.59</mfgdigver>
</netft>
)";

// An Axia80, in the elements that public drivers and stand-ins of it read: <commrdtrate> in place of <comrdtrate>, no
// name of the configuration.
inline constexpr std::string_view netft_axia_answer = R"(<?xml version="1.0"?><netft>
<runstat>0x00000000</runstat><runrate>7912</runrate><cfgcalsel>0</cfgcalsel><cfgcalsn>FT31234</cfgcalsn>
<cfgfu>2</cfgfu><scfgfu>N</scfgfu><cfgtu>3</cfgtu><scfgtu>N-m</scfgtu>
<cfgcpf>1000000</cfgcpf><cfgcpt>1000000</cfgcpt><commrdtrate>2000</commrdtrate><comrdtbsiz>1</comrdtbsiz>
</netft>
)";

}  // namespace touchstone::hil
