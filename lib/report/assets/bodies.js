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
function draw(){
const w=cv.clientWidth,h=Math.round(Math.min(window.innerHeight*.7,Math.max(220,w*(hi[1]-lo[1]+.2*size)/(hi[0]-lo[0]+.2*size)))),r=window.devicePixelRatio||1;
cv.width=w*r;cv.height=h*r;cv.style.height=h+"px";ctx.setTransform(r,0,0,r,0,0);ctx.clearRect(0,0,w,h);
const k=Math.min(w/(hi[0]-lo[0]+.2*size),h/(hi[1]-lo[1]+.2*size)),cx=(lo[0]+hi[0])/2,cy=(lo[1]+hi[1])/2;
const X=x=>w/2+(x-cx)*k,Y=y=>h/2-(y-cy)*k,s=auto*Math.pow(10,+sl.value),f=Math.min(+fr.value,D.times.length-1);
document.getElementById("scaled").textContent="displacements x "+show(s);
document.getElementById("time").textContent=D.times.length>1?show(D.times[f])+" s":"";
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
document.getElementById("low").textContent=show(a);document.getElementById("high").textContent=show(z);}
else if(rim){document.getElementById("low").textContent="0";document.getElementById("high").textContent=show(vm);}
const path=(l,u,m)=>{ctx.beginPath();for(let i=0;i<l.length;i+=2){const x=X(l[i]+m*u[i]),y=Y(l[i+1]+m*u[i+1]);i?ctx.lineTo(x,y):ctx.moveTo(x,y);}};
for(const b of D.bodies)for(let n=0;n<b.outline.length;n++){const l=b.outline[n],u=b.frames[f][n];ctx.setLineDash([4,4]);ctx.strokeStyle="#888";ctx.lineWidth=1;path(l,u,0);ctx.stroke();ctx.setLineDash([]);if(fn&&b.cells.length&&b.rim.length){ctx.lineWidth=5;ctx.lineCap="round";for(let i=0;2*i+3<l.length;i++){ctx.strokeStyle=col(z>a?((onRim(b,n,i)+onRim(b,n,i+1))/2-a)/(z-a):.5);ctx.beginPath();ctx.moveTo(X(l[2*i]+s*u[2*i]),Y(l[2*i+1]+s*u[2*i+1]));ctx.lineTo(X(l[2*i+2]+s*u[2*i+2]),Y(l[2*i+3]+s*u[2*i+3]));ctx.stroke();}}
if(b.mises.length){const q=b.mises[f][n];ctx.lineWidth=7;ctx.lineCap="round";for(let i=0;i+3<l.length;i+=2){ctx.strokeStyle=col(vm>0?q[i/2]/vm:0);ctx.beginPath();ctx.moveTo(X(l[i]+s*u[i]),Y(l[i+1]+s*u[i+1]));ctx.lineTo(X(l[i+2]+s*u[i+2]),Y(l[i+3]+s*u[i+3]));ctx.stroke();}}ctx.strokeStyle="#123";ctx.lineWidth=1.6;path(l,u,s);ctx.stroke();}
}
[sl,fr,fld].forEach(e=>e.addEventListener("input",draw));window.addEventListener("resize",draw);
let timer=null;play.addEventListener("click",()=>{if(timer){clearInterval(timer);timer=null;play.textContent="Play";}else{play.textContent="Stop";timer=setInterval(()=>{fr.value=(+fr.value+1)%D.times.length;draw();},60);}});
const hist=k=>D.points.map(p=>({n:p.name,p:D.times.map((t,i)=>[t,p.u[2*i+k]])}));
if(D.times.length>1){chart2d("ux",hist(0),"time (s)","x displacement (m)");chart2d("uy",hist(1),"time (s)","y displacement (m)");
const sh=D.points.filter(p=>p.s.length);
["xx","yy","xy"].forEach((n,k)=>chart2d("s"+n,sh.map(p=>({n:p.name,p:D.times.map((t,i)=>[t,p.s[3*i+k]])})),"time (s)","stress "+n+" (Pa)"));
chart2d("energy",["kinetic","elastic","gravity"].map((n,k)=>({n:n,p:D.times.map((t,i)=>[t,D.energy[i][k]])})),"time (s)","energy (J/m)");}
chart2d("trials",[{n:"",p:D.trials.filter(t=>t[1]>0&&t[2]>0).map(t=>[t[1],t[2]])}],"time (s)","estimated error",{log:true});
draw();
