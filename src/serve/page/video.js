// The result as a video by WebRTC: far fewer bytes than JPEGs.

async function* lines(response) {
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let waiting = "";
  while (true) {
    const { value, done } = await reader.read();
    if (done) return;
    waiting += value;
    for (let end; (end = waiting.indexOf("\n")) >= 0; waiting = waiting.slice(end + 1)) {
      if (end > 0) yield JSON.parse(waiting.slice(0, end));
    }
  }
}

export const canWatch = () => "RTCPeerConnection" in globalThis && "requestVideoFrameCallback" in HTMLVideoElement.prototype;

// Plays in `video` until `signal` ends it, or fails with an Error. Calls `onPicture` for each picture.
export async function watch(video, signal, onPicture) {
  const peer = new RTCPeerConnection();
  const { receiver } = peer.addTransceiver("video", { direction: "recvonly" });
  // The newest picture at once rather than an even motion.
  if ("jitterBufferTarget" in receiver) receiver.jitterBufferTarget = 0;
  if ("playoutDelayHint" in receiver) receiver.playoutDelayHint = 0;
  const ended = new AbortController();
  const end = () => ended.abort();
  signal.addEventListener("abort", end);
  const step = (now, metadata) => {
    if (ended.signal.aborted) return;
    onPicture(metadata);
    video.requestVideoFrameCallback(step);
  };
  let failure;
  peer.onconnectionstatechange = () => {
    if (!["failed", "disconnected", "closed"].includes(peer.connectionState)) return;
    failure = new Error(`the connection is ${peer.connectionState}`);
    end();
  };
  const silence = setTimeout(() => {
    if (peer.connectionState === "connected") return;
    failure = new Error("no connection");
    end();
  }, 8000);
  try {
    await peer.setLocalDescription();
    const { type, sdp } = peer.localDescription;
    const response = await fetch("api/webrtc", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ type, sdp, view: "after" }),
      signal: ended.signal,
    });
    if (!response.ok) throw new Error((await response.json()).error);
    for await (const line of lines(response)) {
      if (line.error) throw new Error(line.error);
      await peer.setRemoteDescription(line);
      video.srcObject = new MediaStream([receiver.track]);
      video.requestVideoFrameCallback(step);
      video.play().catch(() => {});
    }
    throw new Error("the video has ended");
  } catch (error) {
    if (!signal.aborted) throw failure ?? error;
  } finally {
    clearTimeout(silence);
    signal.removeEventListener("abort", end);
    end();
    peer.close();
    video.srcObject = null;
  }
}
