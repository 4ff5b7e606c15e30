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
// The largest stress is often on the boundary, where no cell has its centre.
const onRim=(b,n,i)=>{const u=b.frames[f][n],q=b.rim[n];return fn([0,0,0,u[2*i],u[2*i+1],q[4*i],q[4*i+1],q[4*i+2],q[4*i+3]]);};
if(fn){for(const b of D.bodies){for(const c of b.cells){const v=fn(c);a=Math.min(a,v);z=Math.max(z,v);}
if(b.cells.length)for(let n=0;n<b.rim.length;n++)for(let i=0;4*i<b.rim[n].length;i++){const v=onRim(b,n,i);a=Math.min(a,v);z=Math.max(z,v);}}
for(const b of D.bodies){if(!b.cells.length)continue;
// Cut to the deformed outline; larger cells below fill what lies between the outermost cells and it.
ctx.save();ctx.beginPath();let bx=[1e300,1e300,-1e300,-1e300];
for(let n=0;n<b.outline.length;n++){const l=b.outline[n],u=b.frames[f][n];for(let i=0;i<l.length;i+=2){const x=X(l[i]+s*u[i]),y=Y(l[i+1]+s*u[i+1]);i?ctx.lineTo(x,y):ctx.moveTo(x,y);bx=[Math.min(bx[0],l[i]),Math.min(bx[1],l[i+1]),Math.max(bx[2],l[i]),Math.max(bx[3],l[i+1])];}ctx.closePath();}
const infinite=b.cells.some(c=>c[0]<bx[0]||c[0]>bx[2]||c[1]<bx[1]||c[1]>bx[3]);if(infinite)ctx.rect(0,0,w,h);ctx.clip("evenodd");
for(const grow of [2.2,1.04])for(const c of b.cells){ctx.fillStyle=col(z>a?(fn(c)-a)/(z-a):.5);const q=c[2]*k*grow+.6;ctx.fillRect(X(c[0]+s*c[3])-q/2,Y(c[1]+s*c[4])-q/2,q,q);}
ctx.restore();}
document.getElementById("low").textContent=fmt(a);document.getElementById("high").textContent=fmt(z);}
else if(rim){document.getElementById("low").textContent="0";document.getElementById("high").textContent=fmt(vm);}
const path=(l,u,m)=>{ctx.beginPath();for(let i=0;i<l.length;i+=2){const x=X(l[i]+m*u[i]),y=Y(l[i+1]+m*u[i+1]);i?ctx.lineTo(x,y):ctx.moveTo(x,y);}};
for(const b of D.bodies)for(let n=0;n<b.outline.length;n++){const l=b.outline[n],u=b.frames[f][n];ctx.setLineDash([4,4]);ctx.strokeStyle="#888";ctx.lineWidth=1;path(l,u,0);ctx.stroke();ctx.setLineDash([]);if(fn&&b.cells.length&&b.rim.length){ctx.lineWidth=5;ctx.lineCap="round";for(let i=0;2*i+3<l.length;i++){ctx.strokeStyle=col(z>a?((onRim(b,n,i)+onRim(b,n,i+1))/2-a)/(z-a):.5);ctx.beginPath();ctx.moveTo(X(l[2*i]+s*u[2*i]),Y(l[2*i+1]+s*u[2*i+1]));ctx.lineTo(X(l[2*i+2]+s*u[2*i+2]),Y(l[2*i+3]+s*u[2*i+3]));ctx.stroke();}}
if(b.mises.length){const q=b.mises[f][n];ctx.lineWidth=7;ctx.lineCap="round";for(let i=0;i+3<l.length;i+=2){ctx.strokeStyle=col(vm>0?q[i/2]/vm:0);ctx.beginPath();ctx.moveTo(X(l[i]+s*u[i]),Y(l[i+1]+s*u[i+1]));ctx.lineTo(X(l[i+2]+s*u[i+2]),Y(l[i+3]+s*u[i+3]));ctx.stroke();}}ctx.strokeStyle="#123";ctx.lineWidth=1.6;path(l,u,s);ctx.stroke();}
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
