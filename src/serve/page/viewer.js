import { element } from "./dom.js";
import { explain } from "./intro.js";
import { allowVideo, startPicture } from "./picture.js";
import { showProblems } from "./problems.js";
import { complain, complaint, startSettings } from "./settings.js";
import { showStatus } from "./status.js";
import { post } from "./stream.js";

async function command(path, body) {
  try {
    await post(path, body);
    complain("");
  } catch (error) {
    complain(error.message);
  }
}
element("record").onclick = ({ target }) => command("api/recording", { active: !target.classList.contains("recording") });
element("forget").onclick = () => command("api/memory", { forget: true });

const events = new EventSource("api/events");
events.onmessage = ({ data }) => {
  const status = JSON.parse(data);
  const problems = status.problems.map((text, i) => ({ text, toDo: status.to_do[i] }));
  showProblems(complaint ? [{ text: complaint, toDo: "" }, ...problems] : problems);
  showStatus(status);
  allowVideo(status.video.available);
};
events.onerror = () => showProblems([{
  text: "No answer from diminish; trying again",
  toDo: "see in its terminal whether it still runs, and start it again. This page goes on by itself",
}]);
explain(await startSettings());
startPicture();
