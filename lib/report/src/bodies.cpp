#include "cleave/report/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "assets.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/report/json.hpp"
#include "cleave/report/text.hpp"
#include "plane_parts.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;

/// Six significant digits: enough for a picture, a third of the bytes.
void short_number(std::string& out, double v) {
  if (!std::isfinite(v)) {
    out += "0";
    return;
  }
  const double size = std::abs(v);
  if (size < 1e-99) {  // far below, powers of ten overflow
    out += "0";
    return;
  }
  const double step = std::pow(10, std::floor(std::log10(size)) - 6);
  append_number(out, std::round(v / step) * step);
}

void append_points(std::string& out, const std::vector<Vec2>& points, Vec2 origin) {
  out += "[";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) out += ",";
    short_number(out, points[i].x - origin.x);
    out += ",";
    short_number(out, points[i].y - origin.y);
  }
  out += "]";
}

/// Data of the page's script: places relative to the first body's centre, displacements a frame.
std::string page_data(const scene::BodiesResult& result) {
  const Vec2 origin = result.bodies.empty() || result.bodies.front().outline.empty()
                          ? Vec2{}
                          : result.bodies.front().outline.front().front();
  std::string out = "{\"times\":[";
  for (std::size_t i = 0; i < result.times.size(); ++i) {
    if (i > 0) out += ",";
    short_number(out, result.times[i]);
  }
  out += "],\"bodies\":[";
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    const scene::BodyResult& body = result.bodies[b];
    if (b > 0) out += ",";
    out += "{\"name\":";
    append_json_string(out, body.name);
    out += ",\"outline\":[";
    for (std::size_t l = 0; l < body.outline.size(); ++l) {
      if (l > 0) out += ",";
      append_points(out, body.outline[l], origin);
    }
    out += "],\"frames\":[";
    for (std::size_t f = 0; f < body.frames.size(); ++f) {
      if (f > 0) out += ",";
      out += "[";
      for (std::size_t l = 0; l < body.frames[f].size(); ++l) {
        if (l > 0) out += ",";
        std::vector<Vec2> u;
        for (std::size_t k = 0; k < body.frames[f][l].size(); ++k)
          u.push_back(body.frames[f][l][k] - body.outline[l][k]);
        append_points(out, u, {});
      }
      out += "]";
    }
    out += "],\"mises\":[";
    for (std::size_t f = 0; f < body.mises_frames.size(); ++f) {
      out += f > 0 ? ",[" : "[";
      for (std::size_t l = 0; l < body.mises_frames[f].size(); ++l) {
        out += l > 0 ? ",[" : "[";
        for (std::size_t k = 0; k < body.mises_frames[f][l].size(); ++k) {
          if (k > 0) out += ",";
          short_number(out, body.mises_frames[f][l][k]);
        }
        out += "]";
      }
      out += "]";
    }
    out += "],\"cells\":[";
    for (std::size_t c = 0; c < body.cells.size(); ++c) {
      const scene::StressCell& cell = body.cells[c];
      if (c > 0) out += ",";
      out += "[";
      for (const double v : {cell.centre.x - origin.x, cell.centre.y - origin.y, cell.size, cell.displacement.x,
                             cell.displacement.y, cell.stress.xx, cell.stress.yy, cell.stress.xy, cell.out_of_plane}) {
        short_number(out, v);
        out += ",";
      }
      out.back() = ']';
    }
    out += "]}";
  }
  out += "],\"points\":[";
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    if (p > 0) out += ",";
    out += "{\"name\":";
    append_json_string(out, result.points[p].name);
    out += ",\"u\":";
    append_points(out, result.points[p].displacement, {});
    out += ",\"s\":[";
    for (std::size_t f = 0; f < result.points[p].stress.size(); ++f) {
      const bem::Sym2 s = result.points[p].stress[f];
      for (const double v : {s.xx, s.yy, s.xy}) {
        if (out.back() != '[') out += ",";
        short_number(out, v);
      }
    }
    out += "]}";
  }
  out += "],\"energy\":[";
  for (std::size_t f = 0; f < result.energy.size(); ++f) {
    if (f > 0) out += ",";
    out += "[";
    for (const double e : result.energy[f]) {
      short_number(out, e);
      out += ",";
    }
    out.back() = ']';
  }
  out += "],\"trials\":[";
  for (std::size_t t = 0; t < result.trials.size(); ++t) {
    if (t > 0) out += ",";
    out += "[";
    append_number(out, static_cast<double>(result.trials[t].elements));
    out += ",";
    short_number(out, result.trials[t].seconds);
    out += ",";
    short_number(out, result.trials[t].error);
    out += "]";
  }
  out += "]}";
  return out;
}

constexpr std::string_view script = R"js(
"use strict";
const D=JSON.parse(document.getElementById("data").textContent);
const cv=document.getElementById("view"),ctx=cv.getContext("2d");
const sl=document.getElementById("scale"),fr=document.getElementById("frame"),fld=document.getElementById("field"),play=document.getElementById("play");
let lo=[1e300,1e300],hi=[-1e300,-1e300],um=0;
for(const b of D.bodies){for(const l of b.outline)for(let i=0;i<l.length;i+=2){lo=[Math.min(lo[0],l[i]),Math.min(lo[1],l[i+1])];hi=[Math.max(hi[0],l[i]),Math.max(hi[1],l[i+1])];}
for(const c of b.cells){lo=[Math.min(lo[0],c[0]),Math.min(lo[1],c[1])];hi=[Math.max(hi[0],c[0]),Math.max(hi[1],c[1])];}
for(const f of b.frames)for(const l of f)for(let i=0;i<l.length;i+=2)um=Math.max(um,Math.hypot(l[i],l[i+1]));}
const size=Math.max(hi[0]-lo[0],hi[1]-lo[1])||1,large=um>0.05*size;
let auto=um>0?(large?1:0.05*size/um):1;
if(large)for(const b of D.bodies)for(let f=0;f<b.frames.length;f++)for(let k=0;k<b.outline.length;k++){const l=b.outline[k],u=b.frames[f][k];for(let i=0;i<l.length;i+=2){lo=[Math.min(lo[0],l[i]+u[i]),Math.min(lo[1],l[i+1]+u[i+1])];hi=[Math.max(hi[0],l[i]+u[i]),Math.max(hi[1],l[i+1]+u[i+1])];}}
const F={"von Mises":c=>Math.sqrt(Math.max(0,0.5*((c[5]-c[6])**2+(c[6]-c[8])**2+(c[8]-c[5])**2)+3*c[7]*c[7])),
"largest principal":c=>(c[5]+c[6])/2+Math.hypot((c[5]-c[6])/2,c[7]),"smallest principal":c=>(c[5]+c[6])/2-Math.hypot((c[5]-c[6])/2,c[7]),
"xx":c=>c[5],"yy":c=>c[6],"xy":c=>c[7],"displacement":c=>Math.hypot(c[3],c[4])};
const has=D.bodies.some(b=>b.cells.length),rim=D.bodies.some(b=>b.mises.length);let vm=0;
for(const b of D.bodies)for(const f of b.mises)for(const l of f)for(const v of l)vm=Math.max(vm,v);
if(has)for(const n in F){const o=document.createElement("option");o.textContent=n;fld.append(o);}else fld.parentNode.style.display="none";
if(D.times.length<2){fr.parentNode.parentNode.style.display="none";}else{fr.max=D.times.length-1;fr.value=fr.max;}
const col=t=>{const s=[[68,1,84],[59,82,139],[33,145,140],[94,201,98],[253,231,37]];t=Math.min(.9999,Math.max(0,t))*4;const i=Math.floor(t),f=t-i;return "rgb("+[0,1,2].map(k=>Math.round(s[i][k]*(1-f)+s[i+1][k]*f)).join(",")+")";};
const fmt=v=>v===0?"0":Math.abs(v)>=1e5||Math.abs(v)<1e-3?v.toExponential(2):String(+v.toPrecision(4));
function draw(){
const w=cv.clientWidth,h=Math.round(Math.min(window.innerHeight*.7,Math.max(220,w*(hi[1]-lo[1]+.2*size)/(hi[0]-lo[0]+.2*size)))),r=window.devicePixelRatio||1;
cv.width=w*r;cv.height=h*r;cv.style.height=h+"px";ctx.setTransform(r,0,0,r,0,0);ctx.clearRect(0,0,w,h);
const k=Math.min(w/(hi[0]-lo[0]+.2*size),h/(hi[1]-lo[1]+.2*size)),cx=(lo[0]+hi[0])/2,cy=(lo[1]+hi[1])/2;
const X=x=>w/2+(x-cx)*k,Y=y=>h/2-(y-cy)*k,s=auto*Math.pow(10,+sl.value),f=Math.min(+fr.value,D.times.length-1);
document.getElementById("scaled").textContent="displacements x "+fmt(s);
document.getElementById("time").textContent=D.times.length>1?fmt(D.times[f])+" s":"";
const fn=F[fld.value];let a=1e300,z=-1e300;
if(fn){for(const b of D.bodies)for(const c of b.cells){const v=fn(c);a=Math.min(a,v);z=Math.max(z,v);}
for(const b of D.bodies){if(!b.cells.length)continue;
// Cut to the deformed outline; larger cells below fill what lies between the outermost cells and it.
ctx.save();ctx.beginPath();let bx=[1e300,1e300,-1e300,-1e300];
for(let n=0;n<b.outline.length;n++){const l=b.outline[n],u=b.frames[f][n];for(let i=0;i<l.length;i+=2){const x=X(l[i]+s*u[i]),y=Y(l[i+1]+s*u[i+1]);i?ctx.lineTo(x,y):ctx.moveTo(x,y);bx=[Math.min(bx[0],l[i]),Math.min(bx[1],l[i+1]),Math.max(bx[2],l[i]),Math.max(bx[3],l[i+1])];}ctx.closePath();}
const infinite=b.cells.some(c=>c[0]<bx[0]||c[0]>bx[2]||c[1]<bx[1]||c[1]>bx[3]);if(infinite)ctx.rect(0,0,w,h);ctx.clip("evenodd");
for(const grow of infinite?[1.04]:[2.2,1.04])for(const c of b.cells){ctx.fillStyle=col(z>a?(fn(c)-a)/(z-a):.5);const q=c[2]*k*grow+.6;ctx.fillRect(X(c[0]+s*c[3])-q/2,Y(c[1]+s*c[4])-q/2,q,q);}
ctx.restore();}
document.getElementById("low").textContent=fmt(a);document.getElementById("high").textContent=fmt(z);}
else if(rim){document.getElementById("low").textContent="0";document.getElementById("high").textContent=fmt(vm);}
const path=(l,u,m)=>{ctx.beginPath();for(let i=0;i<l.length;i+=2){const x=X(l[i]+m*u[i]),y=Y(l[i+1]+m*u[i+1]);i?ctx.lineTo(x,y):ctx.moveTo(x,y);}};
for(const b of D.bodies)for(let n=0;n<b.outline.length;n++){const l=b.outline[n],u=b.frames[f][n];ctx.setLineDash([4,4]);ctx.strokeStyle="#888";ctx.lineWidth=1;path(l,u,0);ctx.stroke();ctx.setLineDash([]);if(b.mises.length){const q=b.mises[f][n];ctx.lineWidth=7;ctx.lineCap="round";for(let i=0;i+3<l.length;i+=2){ctx.strokeStyle=col(vm>0?q[i/2]/vm:0);ctx.beginPath();ctx.moveTo(X(l[i]+s*u[i]),Y(l[i+1]+s*u[i+1]));ctx.lineTo(X(l[i+2]+s*u[i+2]),Y(l[i+3]+s*u[i+3]));ctx.stroke();}}ctx.strokeStyle="#123";ctx.lineWidth=1.6;path(l,u,s);ctx.stroke();}
}
[sl,fr,fld].forEach(e=>e.addEventListener("input",draw));window.addEventListener("resize",draw);
let timer=null;play.addEventListener("click",()=>{if(timer){clearInterval(timer);timer=null;play.textContent="Play";}else{play.textContent="Stop";timer=setInterval(()=>{fr.value=(+fr.value+1)%D.times.length;draw();},60);}});
function chart(id,series,xl,yl,log){const el=document.getElementById(id);if(!el)return;const W=640,H=300,m=[14,36,40,74];let x0=1e300,x1=-1e300,y0=1e300,y1=-1e300;const T=v=>log?Math.log10(Math.max(v,1e-300)):v;
for(const s of series)for(const p of s.p){x0=Math.min(x0,T(p[0]));x1=Math.max(x1,T(p[0]));y0=Math.min(y0,T(p[1]));y1=Math.max(y1,T(p[1]));}
if(!(x1>x0)){x0-=.5;x1+=.5;}if(!(y1>y0)){const d=Math.abs(y0)||1;y0-=d/2;y1+=d/2;}
const X=v=>m[3]+(T(v)-x0)/(x1-x0)*(W-m[1]-m[3]),Y=v=>H-m[2]-(T(v)-y0)/(y1-y0)*(H-m[0]-m[2]);const c=["#0072b2","#d55e00","#009e73","#cc79a7","#e69f00","#56b4e9"];
let o='<svg viewBox="0 0 '+W+' '+H+'" role="img" style="max-width:100%">';
for(let i=0;i<=4;i++){const vy=y0+(y1-y0)*i/4,vx=x0+(x1-x0)*i/4,py=H-m[2]-(H-m[0]-m[2])*i/4,px=m[3]+(W-m[1]-m[3])*i/4;o+='<path d="M'+m[3]+' '+py+'H'+(W-m[1])+'" stroke="#ddd"/><text x="'+(m[3]-6)+'" y="'+(py+4)+'" text-anchor="end" font-size="11">'+fmt(log?10**vy:vy)+'</text><text x="'+px+'" y="'+(H-m[2]+16)+'" text-anchor="middle" font-size="11">'+fmt(log?10**vx:vx)+'</text>';}
series.forEach((s,i)=>{if(s.p.length>1)o+='<path fill="none" stroke="'+c[i%6]+'" stroke-width="1.6" d="M'+s.p.map(p=>X(p[0]).toFixed(1)+" "+Y(p[1]).toFixed(1)).join("L")+'"/>';if(log)for(const p of s.p)o+='<circle r="4" fill="'+c[i%6]+'" cx="'+X(p[0])+'" cy="'+Y(p[1])+'"/>';o+='<text x="'+(m[3]+8)+'" y="'+(m[0]+14+14*i)+'" font-size="12" fill="'+c[i%6]+'">'+s.n.replace(/&/g,"&amp;").replace(/</g,"&lt;")+'</text>';});
el.innerHTML=o+'<text x="'+W/2+'" y="'+(H-6)+'" text-anchor="middle" font-size="12">'+xl+'</text><text transform="translate(13 '+H/2+') rotate(-90)" text-anchor="middle" font-size="12">'+yl+'</text></svg>';}
const hist=k=>D.points.map(p=>({n:p.name,p:D.times.map((t,i)=>[t,p.u[2*i+k]])}));
if(D.times.length>1){chart("ux",hist(0),"time (s)","x displacement (m)");chart("uy",hist(1),"time (s)","y displacement (m)");
const sh=D.points.filter(p=>p.s.length);
["xx","yy","xy"].forEach((n,k)=>chart("s"+n,sh.map(p=>({n:p.name,p:D.times.map((t,i)=>[t,p.s[3*i+k]])})),"time (s)","stress "+n+" (Pa)"));
chart("energy",["kinetic","elastic","gravity"].map((n,k)=>({n:n,p:D.times.map((t,i)=>[t,D.energy[i][k]])})),"time (s)","energy (J/m)");}
chart("trials",[{n:"",p:D.trials.filter(t=>t[1]>0&&t[2]>0).map(t=>[t[1],t[2]])}],"time (s)","estimated error",true);
draw();
)js";

std::string table_row(std::initializer_list<std::string> cells, bool head = false) {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += (head ? "<th>" : "<td>") + cell + (head ? "</th>" : "</td>");
  return out + "</tr>\n";
}

}  // namespace

std::string bodies_summary_json(const scene::BodiesResult& result) {
  JsonWriter json;
  json.begin_object();
  write_plane_head(json, result);
  json.key("elastic");
  json.begin_object();
  json.member("status", result.converged ? "converged" : "stopped");
  if (!result.converged) json.member("reason", result.stopped_why);
  json.member("steps", result.steps);
  json.member("residual", result.residual);
  json.member("max_displacement_m", result.largest_displacement);
  json.key("bodies");
  json.begin_array();
  for (const scene::BodyResult& body : result.bodies) {
    json.begin_object();
    json.member("name", body.name);
    write_pair(json, "centroid", body.centroid);
    json.member("rotation", body.rotation * 180 / std::numbers::pi);
    json.member("method", body.method);
    json.member("elements", static_cast<std::uint64_t>(body.elements));
    json.member("unknowns", static_cast<std::uint64_t>(body.unknowns));
    json.member("max_displacement_m", body.largest);
    if (body.condition > 0) {
      json.member("condition", body.condition);
      json.member("imbalance", body.imbalance);
    }
    json.key("estimated_error");
    if (body.error) {
      json.value(*body.error);
    } else {
      json.null();
      json.member("no_estimate", body.no_estimate.empty() ? std::string{"nothing moves"} : body.no_estimate);
    }
    if (!body.modes_hz.empty()) {
      json.key("modes_hz");
      json.begin_array();
      for (const double f : body.modes_hz) json.value(f);
      json.end_array();
    }
    if (result.steps > 0) {
      json.member("rebuilds", static_cast<std::uint64_t>(body.rebuilds));
      json.member("strain_since_build", body.strain_since_build);
    }
    json.end_object();
  }
  json.end_array();
  json.key("points");
  json.begin_array();
  for (const scene::PointResult& point : result.points) {
    json.begin_object();
    json.member("name", point.name);
    write_pair(json, "displacement", point.displacement.empty() ? Vec2{} : point.displacement.back());
    if (!point.stress.empty()) {
      json.key("stress");
      json.begin_array();
      const bem::Sym2 s = point.stress.back();
      for (const double v : {s.xx, s.yy, s.xy}) json.value(v);
      json.end_array();
    }
    json.end_object();
  }
  json.end_array();
  json.end_object();
  json.end_object();
  return std::move(json).finish();
}

std::string bodies_report_html(const scene::BodiesResult& result) {
  std::string out = plane_page_head(
      result.title, escape_xml(result.scene_file) + " · lengths in metres, x to the right, y up",
      ".controls label{display:inline-block;margin:.3em 1em .3em 0}#view{width:100%;display:block;background:#fff}"
      ".legend{height:12px;background:linear-gradient(90deg,#440154,#3b528b,#21918c,#5ec962,#fde725);max-width:560px}"
      ".legend-ends{display:flex;justify-content:space-between;gap:1em;max-width:560px;white-space:nowrap}"
      ".plain td,.plain th{text-align:left}.wide-table{overflow-x:auto}.wide-table "
      "td:last-child{white-space:normal;min-width:12em}@media print{.controls{display:none}}");
  out += "<section><h2>Result</h2>\n<p>";
  out += result.converged ? "The run converged."
                          : "The run <strong>stopped</strong>: " + escape_xml(result.stopped_why) + ".";
  out += " Largest displacement " + display(result.largest_displacement) + " m";
  if (result.steps > 0) out += ", " + display_count(result.steps) + " steps";
  const bool moving = result.steps > 0;
  out += ".</p>\n<div class=\"wide-table\"><table>\n" +
         table_row({"body", "elements", "unknowns", "largest displacement (m)", "rotation (°)", "estimated error",
                    moving ? "rebuilds" : "condition", "method"},
                   true);
  for (const scene::BodyResult& body : result.bodies) {
    out += table_row({escape_xml(body.name), display_count(body.elements), display_count(body.unknowns),
                      display(body.largest), display(body.rotation * 180 / std::numbers::pi),
                      body.error ? display(*body.error, 2) : "–",
                      moving               ? display_count(body.rebuilds)
                      : body.condition > 0 ? display(body.condition, 2)
                                           : "–",
                      escape_xml(body.method)});
  }
  out += "</table></div>\n";
  for (const scene::BodyResult& body : result.bodies) {
    if (!body.error && !body.no_estimate.empty()) {
      out += "<p>" + escape_xml(body.name) + ": no estimate of the error: " + escape_xml(body.no_estimate) + ".</p>\n";
    }
    if (body.modes_hz.empty()) continue;
    std::string list;
    for (const double f : body.modes_hz) list += (list.empty() ? "" : ", ") + display(f, 5);
    out += "<p>Natural frequencies of " + escape_xml(body.name) + ": " + list + " Hz.</p>\n";
  }
  out +=
      "</section>\n<section><h2>Deformed shape</h2>\n<p class=\"controls\"><label>scale <input "
      "id=\"scale\" "
      "type=\"range\" min=\"-2\" max=\"2\" step=\"0.05\" value=\"0\"></label><span id=\"scaled\"></span> <label>field "
      "<select id=\"field\"></select></label> <span><label>frame <input id=\"frame\" type=\"range\" min=\"0\" "
      "max=\"0\" "
      "value=\"0\"></label><button id=\"play\">Play</button> <span id=\"time\"></span></span></p>\n"
      "<canvas id=\"view\" aria-label=\"deformed shape\"></canvas>\n";
  bool cells = false;
  bool rim = false;
  for (const scene::BodyResult& body : result.bodies) {
    cells = cells || !body.cells.empty();
    rim = rim || !body.mises_frames.empty();
  }
  if (rim) {
    out +=
        "<div class=\"legend\"></div><div class=\"legend-ends\"><span id=\"low\"></span><span>Pa, von Mises on the "
        "boundary</span><span id=\"high\"></span></div>\n";
  } else if (cells) {
    out +=
        "<div class=\"legend\"></div><div class=\"legend-ends\"><span id=\"low\"></span><span>Pa, tension positive "
        "(displacement: m)</span><span id=\"high\"></span></div>\n";
  } else {
    out += "<span id=\"low\" hidden></span><span id=\"high\" hidden></span>\n";
  }
  out += "<p>Dashed: undeformed.</p>\n</section>\n";
  if (result.times.size() > 1) {
    out += "<section><h2>Histories</h2>\n";
    if (!result.points.empty()) out += "<div id=\"ux\"></div><div id=\"uy\"></div>\n";
    out += "<div id=\"energy\"></div>\n";
    if (std::ranges::any_of(result.points, [](const auto& p) { return !p.stress.empty(); }))
      out += "<div id=\"sxx\"></div><div id=\"syy\"></div><div id=\"sxy\"></div>\n";
    out += "</section>\n";
  }
  if (!result.points.empty()) {
    out += "<section><h2>Points</h2>\n<table>\n" + table_row({"point", "x (m)", "y (m)", "u<sub>x</sub> (m)",
                                                              "u<sub>y</sub> (m)", "xx (Pa)", "yy (Pa)", "xy (Pa)"},
                                                             true);
    for (const scene::PointResult& p : result.points) {
      const Vec2 u = p.displacement.empty() ? Vec2{} : p.displacement.back();
      out += table_row({escape_xml(p.name), display(p.at.x), display(p.at.y), display(u.x, 6), display(u.y, 6),
                        p.stress.empty() ? "–" : display(p.stress.back().xx, 6),
                        p.stress.empty() ? "–" : display(p.stress.back().yy, 6),
                        p.stress.empty() ? "–" : display(p.stress.back().xy, 6)});
    }
    out += "</table>\n</section>\n";
  }
  if (!result.trials.empty()) {
    out +=
        "<section><h2>Error against time</h2>\n<p>The estimate is the change of displacement to the mesh with half as "
        "many elements, over the largest displacement: an upper figure for smooth problems.</p>\n<table>\n" +
        table_row({"body", "elements", "time (s)", "estimated error"}, true);
    for (const scene::MeshTrial& t : result.trials) {
      out += table_row({escape_xml(t.body), display_count(t.elements), display(t.seconds, 2), display(t.error, 2)});
    }
    out += "</table>\n<div id=\"trials\"></div>\n</section>\n";
  }
  out += "<section><h2>What ran</h2>\n<table class=\"plain\">\n" + table_row({"stage", "", "why"}, true);
  for (const scene::PlannedStage& stage : result.plan.stages) {
    out += table_row({std::string{scene::name_of(stage.stage)}, stage.run ? "run" : "left out", escape_xml(stage.why)});
  }
  out += "</table>\n<p>" + display(result.cost.wall_s, 3) + " s, " + display(result.cost.peak_rss_mb, 3) + " MB, " +
         std::to_string(result.cost.threads) + " threads.</p>\n";
  for (const std::string& note : result.notes) out += "<p>Note: " + escape_xml(note) + "</p>\n";
  out +=
      "</section>\n</main>\n<script type=\"application/json\" id=\"data\">" + page_data(result) + "</script>\n<script>";
  out += script;
  out += "</script>\n</body>\n</html>\n";
  return out;
}

std::string bodies_vtu(const scene::BodiesResult& result, std::size_t frame) {
  std::string points, connectivity, offsets, types, displacement, body_id, cell_body, xx, yy, xy;
  std::size_t count = 0, cells = 0, end = 0;
  const auto add_point = [&](Vec2 x, Vec2 u, std::size_t body, bem::Sym2 s) {
    points += number(x.x) + " " + number(x.y) + " 0\n";
    displacement += number(u.x) + " " + number(u.y) + " 0\n";
    body_id += std::to_string(body) + "\n";
    xx += number(s.xx) + "\n";
    yy += number(s.yy) + "\n";
    xy += number(s.xy) + "\n";
    return count++;
  };
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    const scene::BodyResult& body = result.bodies[b];
    for (std::size_t l = 0; l < body.outline.size(); ++l) {
      for (std::size_t k = 0; k < body.outline[l].size(); ++k) {
        const bem::Sym2 s = !body.stress_frames.empty()     ? body.stress_frames[frame][l][k]
                            : !body.boundary_stress.empty() ? body.boundary_stress[l][k]
                                                            : bem::Sym2{};
        connectivity +=
            std::to_string(add_point(body.outline[l][k], body.frames[frame][l][k] - body.outline[l][k], b, s)) + " ";
        ++end;
      }
      offsets += std::to_string(end) + "\n";
      types += "4\n";
      cell_body += std::to_string(b) + "\n";
      ++cells;
    }
    for (const scene::StressCell& c : body.cells) {
      const double h = c.size / 2;
      for (const Vec2 corner : {Vec2{-h, -h}, Vec2{h, -h}, Vec2{h, h}, Vec2{-h, h}}) {
        connectivity += std::to_string(add_point(c.centre + corner, c.displacement, b, c.stress)) + " ";
      }
      end += 4;
      offsets += std::to_string(end) + "\n";
      types += "9\n";
      cell_body += std::to_string(b) + "\n";
      ++cells;
    }
  }
  const auto array = [](std::string_view type, std::string_view name, int components, const std::string& values) {
    return "<DataArray type=\"" + std::string{type} + "\" Name=\"" + std::string{name} + "\"" +
           (components > 1 ? " NumberOfComponents=\"" + std::to_string(components) + "\"" : "") +
           " format=\"ascii\">\n" + values + "</DataArray>\n";
  };
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
         std::to_string(count) + "\" NumberOfCells=\"" + std::to_string(cells) + "\">\n<PointData>\n" +
         array("Float64", "displacement", 3, displacement) + array("Int32", "body_of_point", 1, body_id) +
         array("Float64", "stress_xx", 1, xx) + array("Float64", "stress_yy", 1, yy) +
         array("Float64", "stress_xy", 1, xy) + "</PointData>\n<CellData>\n" + array("Int32", "body", 1, cell_body) +
         "</CellData>\n<Points>\n" + array("Float64", "Points", 3, points) + "</Points>\n<Cells>\n" +
         array("Int64", "connectivity", 1, connectivity + "\n") + array("Int64", "offsets", 1, offsets) +
         array("UInt8", "types", 1, types) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string bodies_points_csv(const scene::BodiesResult& result) {
  std::string out = "time_s,point,x_m,y_m,displacement_x_m,displacement_y_m,stress_xx_pa,stress_yy_pa,stress_xy_pa\n";
  for (std::size_t f = 0; f < result.times.size(); ++f) {
    for (const scene::PointResult& p : result.points) {
      if (f >= p.displacement.size()) continue;
      out += number(result.times[f]) + "," + csv_field(p.name) + "," + number(p.at.x) + "," + number(p.at.y) + "," +
             number(p.displacement[f].x) + "," + number(p.displacement[f].y);
      if (f < p.stress.size()) {
        out += "," + number(p.stress[f].xx) + "," + number(p.stress[f].yy) + "," + number(p.stress[f].xy) + "\n";
      } else {
        out += ",,,\n";
      }
    }
  }
  return out;
}

std::expected<void, WriteError> write_bodies_files(const scene::BodiesResult& result,
                                                   const std::filesystem::path& folder) {
  if (result.output.csv && !result.points.empty()) {
    CLEAVE_CHECK(write_file(folder / "points.csv", bodies_points_csv(result)));
  }
  if (!result.output.vtu) return {};
  if (result.times.size() == 1) return write_file(folder / "bodies.vtu", bodies_vtu(result, 0));
  std::string series =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (std::size_t f = 0; f < result.times.size(); ++f) {
    std::string digits = std::to_string(f);
    digits.insert(0, 4 - std::min<std::size_t>(4, digits.size()), '0');
    const std::string name = "bodies_" + digits + ".vtu";
    CLEAVE_CHECK(write_file(folder / name, bodies_vtu(result, f)));
    series += "<DataSet timestep=\"" + number(result.times[f]) + "\" part=\"0\" file=\"" + name + "\"/>\n";
  }
  return write_file(folder / "bodies.pvd", series + "</Collection>\n</VTKFile>\n");
}

std::expected<void, WriteError> write_bodies_report(const scene::BodiesResult& result,
                                                    const std::filesystem::path& folder) {
  if (!result.output.report) return {};
  return write_file(folder / "report.html", bodies_report_html(result));
}

std::expected<void, WriteError> write_bodies_summary(const scene::BodiesResult& result,
                                                     const std::filesystem::path& folder) {
  return write_file(folder / "summary.json", bodies_summary_json(result));
}

}  // namespace cleave::report
